// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/lean_walls.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <set>

#include "core/error.hpp"
#include "core/merge.hpp"
#include "core/volume.hpp"
#include "support/checks.hpp"
#include "support/small_mesh.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::drawn;
using support::shifted;

Tin merged(const std::vector<Tin>& tiles, Overlap overlap = Overlap::first) {
  Context context;
  return merge(tiles, {overlap, {}}, context).surface.tin;
}

Leaned leaned(const Tin& tin, double offset) {
  Context context;
  return lean_walls(tin, offset, {}, context);
}

std::string wrong_with(const Tin& tin) {
  std::set<std::pair<double, double>> places;
  for (const Point& p : tin.vertices)
    if (!places.emplace(p.x, p.y).second) return "two heights at one place";
  return support::wrong_with(tin);
}

double area(const Tin& tin) {
  Context context;
  return plan_area(tin, context);
}

TEST(LeanWalls, AStraightWallFromBorderToBorder) {
  const Tin tin = merged({drawn("222\n222\n222"), drawn("55555\n55555\n55555")});
  const Leaned result = leaned(tin, 0.01);
  EXPECT_EQ(wrong_with(result.tin), "");
  EXPECT_EQ(result.moved, 3u);
  EXPECT_NEAR(result.max_move, 0.01, 1e-12);
  EXPECT_NEAR(result.min_offset, 0.01, 1e-12);
  EXPECT_DOUBLE_EQ(area(result.tin), area(tin));
  const support::Sampler z(result.tin);
  EXPECT_EQ(z({1.985, 1.2}), 2) << "the foot lies inside the lower surface";
  EXPECT_NEAR(z({1.995, 1.2}), 3.5, 1e-9);
  EXPECT_NEAR(z({2.001, 1.2}), 5, 1e-12);
}

TEST(LeanWalls, ATowerAndAPit) {
  const Tin ground = support::patch(0, 0, 8, 8, 1);
  for (const double lift : {50.0, -50.0}) {
    const Tin tin = merged({shifted(support::patch(2.5, 2.5, 2, 3, 1), 0, 0, lift), ground});
    const Leaned result = leaned(tin, 0.001);
    EXPECT_EQ(wrong_with(result.tin), "");
    EXPECT_EQ(result.min_offset, 0.001);
    EXPECT_NEAR(area(result.tin), 64, 1e-9);
  }
}

TEST(LeanWalls, SeveralHeightsAtOnePlace) {
  std::vector<Tin> tiles;
  for (int i = 0; i < 4; ++i) tiles.push_back(shifted(drawn("00\n00"), i % 2, i / 2, (i * 7) % 5));
  const Leaned result = leaned(merged(tiles), 0.01);
  EXPECT_EQ(wrong_with(result.tin), "");
  EXPECT_NEAR(area(result.tin), 4, 1e-9);
}

TEST(LeanWalls, NothingToLeanIsLeftAsItIs) {
  const Tin tin = support::random_terrain(100, 3);
  EXPECT_EQ(leaned(tin, 0.1).tin, tin);
  const Tin walled = merged({drawn("22\n22"), drawn("555\n555")});
  EXPECT_EQ(leaned(walled, 0).tin, walled);
}

TEST(LeanWalls, NarrowSurfacesAreLeanedLess) {
  const Tin strip = shifted(support::patch(0, 0, 1, 20, 0.05), 5, 0, -30);
  const Tin tin = merged({strip, support::patch(0, 0, 10, 1, 1)});
  const Leaned result = leaned(tin, 0.04);
  EXPECT_EQ(wrong_with(result.tin), "");
  EXPECT_LT(result.min_offset, 0.04);
}

TEST(LeanWalls, AnyMergesBecomeSingleValued) {
  support::Random random(23);
  int leaned_ones = 0, refused = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    std::vector<Tin> tiles;
    for (int i = 0; i < 3; ++i) {
      std::vector<Point> points;
      for (int p = 0; p < 7; ++p)
        points.push_back(
            {1.0 * support::below(random, 12), 1.0 * support::below(random, 12), 1.0 * support::below(random, 5)});
      Tin tile = support::swept(points);
      if (support::below(random, 2) == 0)
        tile = support::without(tile, [&](Point2) { return support::below(random, 3) == 0; });
      if (!tile.faces.empty()) tiles.push_back(canonical(tile));
    }
    const Tin tin = merged(tiles, trial % 2 == 0 ? Overlap::first : Overlap::sum);
    try {
      const Leaned result = leaned(tin, 0.001);
      ASSERT_EQ(wrong_with(result.tin), "") << "trial " << trial;
      EXPECT_NEAR(area(result.tin), area(tin), 0.03) << "trial " << trial;
      leaned_ones += result.moved > 0;
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(leaned_ones, 1000);
  EXPECT_LE(refused, 1) << "parts that touch at a corner only, at different heights, may be refused";
}

TEST(LeanWalls, AQuarterOfAMillionFacesTakeSeconds) {
  std::vector<Tin> tiles;
  for (int i = 0; i < 64; ++i) tiles.push_back(support::patch(10 * (i % 8), 10 * (i / 8), 45, 45, 10.0 / 45, i % 3));
  const Tin tin = merged(tiles);
  EXPECT_GT(tin.faces.size(), 250000u);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(wrong_with(leaned(tin, 0.001).tin), "");
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 20);
}

}  // namespace
}  // namespace terrane
