// SPDX-License-Identifier: GPL-3.0-or-later

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "core/merge.hpp"
#include "core/validate.hpp"
#include "support/checks.hpp"
#include "support/merge_judge.hpp"
#include "support/small_mesh.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::drawn;
using support::open_seams;
using support::shifted;
using support::wrong_with;

Merged bridged(const std::vector<Tin>& tiles, double gap, Overlap overlap = Overlap::mean) {
  Context context;
  return merge(tiles, {overlap, {}, {}, gap}, context);
}

TEST(Gaps, ASlitIsBridgedBetweenItsBorders) {
  const Tin west = drawn("111\n111\n111"), east = shifted(drawn("333\n333\n333"), 2.25, 0);
  const Merged result = bridged({west, east}, 0.25);
  EXPECT_EQ(result.bridged.slits, 1u);
  EXPECT_NEAR(result.bridged.area, 0.5, 1e-12);
  EXPECT_EQ(wrong_with(result.surface.tin), "");
  EXPECT_EQ(inspect(result.surface.tin).components, 1u);
  const support::Sampler z(result.surface.tin);
  EXPECT_NEAR(z({2.125, 0.7}), 2, 1e-12) << "halfway between both sides";
  EXPECT_EQ(result.surface.wall_area, 0);
}

TEST(Gaps, NothingWiderIsBridged) {
  const Tin west = drawn("111\n111\n111"), east = shifted(west, 2.25, 0);
  const Merged result = bridged({west, east}, 0.2499);
  EXPECT_EQ(result.bridged.faces, 0u);
  EXPECT_EQ(result.surface.tin.faces.size(), west.faces.size() + east.faces.size());
}

TEST(Gaps, SparseAndDenseBordersThatAreNotAsLong) {
  const Tin west = drawn("0a\na0", 6);
  const Tin east = shifted(support::patch(0, 0, 4, 16, 0.5, 3), 6.1, -1);
  const Merged result = bridged({west, east}, 0.2);
  EXPECT_EQ(wrong_with(result.surface.tin), "");
  EXPECT_EQ(inspect(result.surface.tin).components, 1u);
  EXPECT_NEAR(result.bridged.area, 0.6, 0.021) << "what lies between both, and its ends at most as long as the gap";
}

TEST(Gaps, AWedgeIsBridgedUpToItsWidth) {
  const Tin lower{{{0, 0, 0}, {100, 0, 0}, {50, -50, 0}}, {{0, 2, 1}}};
  const Tin upper{{{0, 0.1, 0}, {100, 1.1, 0}, {50, 50, 0}}, {{0, 1, 2}}};
  const Merged result = bridged({lower, upper}, 0.5);
  EXPECT_EQ(wrong_with(result.surface.tin), "");
  EXPECT_EQ(inspect(result.surface.tin).components, 1u);
  EXPECT_NEAR(result.bridged.area, 40 * 0.3, 0.2);
}

TEST(Gaps, WhereSlitsCrossNoHoleIsLeft) {
  std::vector<Tin> tiles;
  for (int i = 0; i < 4; ++i)
    tiles.push_back(support::patch(5.1 * (i % 2), 5.1 * (i / 2), 5 + i, 5 + i, 5.0 / (5 + i)));
  const Merged result = bridged(tiles, 0.12);
  const Inspection seen = inspect(result.surface.tin);
  EXPECT_EQ(seen.components, 1u);
  EXPECT_EQ(seen.holes, 0u);
  EXPECT_NEAR(result.bridged.area, 4 * 5 * 0.1 + 0.01, 1e-9);
  EXPECT_EQ(wrong_with(result.surface.tin), "");
}

TEST(Gaps, VoidsAndCracksOfOneTileStay) {
  const Tin holed = support::without(support::patch(0, 0, 8, 8, 1),
                                     [](Point2 c) { return c.x > 3 && c.x < 4 && c.y > 3 && c.y < 4; });
  const Tin away = shifted(support::patch(0, 0, 3, 3, 1), 8.5, 0);
  const Merged result = bridged({holed, away}, 1.0);
  EXPECT_EQ(inspect(result.surface.tin).holes, 1u);
  EXPECT_EQ(inspect(result.surface.tin).components, 1u);
}

TEST(Gaps, AreTheSameInAnyOrder) {
  std::vector<Tin> tiles;
  for (int i = 0; i < 4; ++i)
    tiles.push_back(support::jittered(support::patch(5.1 * (i % 2), 5.1 * (i / 2), 7, 9, 5.0 / 9), 0.02, true,
                                      3 + static_cast<std::uint64_t>(i)));
  for (const Overlap overlap : {Overlap::min, Overlap::max, Overlap::mean, Overlap::median, Overlap::sum}) {
    const Merged result = bridged(tiles, 0.4, overlap);
    EXPECT_GT(result.bridged.faces, 0u);
    EXPECT_EQ(wrong_with(result.surface.tin), "");
    std::vector<Tin> reversed(tiles.rbegin(), tiles.rend());
    EXPECT_EQ(bridged(reversed, 0.4, overlap).surface.tin, result.surface.tin);
  }
}

TEST(Gaps, NoPlaceOfABridgeIsFarFromABorder) {
  support::Random random(11);
  for (int trial = 0; trial < 1500; ++trial) {
    std::vector<Tin> tiles;
    for (int i = 0; i < 3; ++i) {
      std::vector<Point> points;
      for (int p = 0; p < 7; ++p)
        points.push_back(
            {support::uniform(random, 0, 10), support::uniform(random, 0, 10), 1.0 * support::below(random, 5)});
      Tin tile = canonical(support::flipped(support::swept(points), 3, random));
      tile = support::without(tile, [&](Point2) { return support::below(random, 3) == 0; });
      if (!tile.faces.empty()) tiles.push_back(tile);
    }
    const double gap = support::uniform(random, 0.05, 1.5);
    const Merged open = bridged(tiles, 0), closed = bridged(tiles, gap);
    ASSERT_EQ(support::wrong_with_surface(closed.surface.tin, false), "") << "trial " << trial;
    const support::Sampler before(open.surface.tin), after(closed.surface.tin);
    if (closed.bridged.faces == 0) continue;
    // From any place of a bridge some straight way across it, from border to border, is no longer than the gap: then
    // the surface is met within half of it times the square root of two, where slits cross.
    for (const Point2 p : support::random_places(bounds(closed.surface.tin), 300, 3)) {
      if (std::isnan(after(p)) || !std::isnan(before(p))) continue;
      bool near = false;
      for (int a = 0; a < 64 && !near; ++a)
        for (const double r : {0.25, 0.5, 0.75, 1.0})
          near =
              near ||
              !std::isnan(before({p.x + r * gap * std::cos(a * 0.0981748), p.y + r * gap * std::sin(a * 0.0981748)}));
      EXPECT_TRUE(near) << "trial " << trial << " at " << p.x << " " << p.y << " gap " << gap;
    }
  }
}

TEST(Gaps, ManyTilesTakeSeconds) {
  std::vector<Tin> tiles;
  for (int i = 0; i < 64; ++i)
    tiles.push_back(support::patch(10.02 * (i % 8), 10.02 * (i / 8), 50 + i % 3, 50 + i % 3, 10.0 / (50 + i % 3)));
  const auto start = std::chrono::steady_clock::now();
  const Merged result = bridged(tiles, 0.05);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 30);
  const Inspection seen = inspect(result.surface.tin);
  EXPECT_EQ(seen.components, 1u);
  EXPECT_EQ(seen.holes, 0u);
}

}  // namespace
}  // namespace terrane
