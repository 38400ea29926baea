// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/arithmetic.hpp"
#include "core/merge.hpp"
#include "core/volume.hpp"
#include "support/checks.hpp"
#include "support/terrains.hpp"

// What sums, differences and merges must satisfy whatever the terrain.
namespace terrane {
namespace {

using support::open_seams;
using support::random_places;
using support::Sampler;
using support::wrong_with;

Tin sum(const Tin& a, const Tin& b, Outside outside = Outside::keep) {
  Context context;
  return combine(a, b, 1, outside, {}, context).tin;
}

Tin difference(const Tin& a, const Tin& b) {
  Context context;
  return combine(a, b, -1, Outside::drop, {}, context).tin;
}

Merged merged(const std::vector<Tin>& tiles, Overlap overlap) {
  Context context;
  return merge(tiles, {overlap, {}}, context);
}

/// Pairs of overlapping surfaces with awkward domains.
std::vector<std::pair<Tin, Tin>> pairs() {
  const Tin a = support::random_terrain(400, 1), b = support::random_terrain(350, 2);
  return {{a, b},
          {a, support::shifted(b, 3000, -2000)},
          {support::with_holes(a), support::islands(b)},
          {support::l_shape(a), support::l_shape(support::without_bad_faces(support::rotated(b, 30)))},
          {support::grid_terrain(12, true), support::grid_terrain(18, false)},
          {support::shifted(a, 500000, 4500000), support::shifted(support::with_holes(b), 500500, 4500500)}};
}

TEST(Algebra, DifferencesCancel) {
  for (const auto& [a, b] : pairs()) {
    const Tin zero = sum(difference(a, b), difference(b, a), Outside::drop);
    EXPECT_FALSE(zero.faces.empty());
    EXPECT_EQ(wrong_with(zero), "");
    for (const Point& p : zero.vertices) EXPECT_EQ(p.z, 0);
  }
}

TEST(Algebra, SumsCommuteToTheByte) {
  for (const auto& [a, b] : pairs()) EXPECT_EQ(sum(a, b), sum(b, a));
}

TEST(Algebra, SumsAreRightEverywhere) {
  for (const auto& [a, b] : pairs()) {
    const Tin c = sum(a, b);
    EXPECT_EQ(wrong_with(c), "");
    EXPECT_EQ(open_seams(c), "");
    const Sampler za(a), zb(b), zc(c);
    for (const Point2 p : random_places(bounds(c), 3000, 3)) {
      const double u = za(p), v = zb(p);
      const double wanted = std::isnan(u) ? v : std::isnan(v) ? u : u + v;
      EXPECT_EQ(std::isnan(wanted), std::isnan(zc(p)));
      if (!std::isnan(wanted)) {
        EXPECT_NEAR(zc(p), wanted, 1e-6);
      }
    }
  }
}

TEST(Algebra, AreaIsThatOfTheUnion) {
  for (const auto& [a, b] : pairs()) {
    const double whole = plan_area(sum(a, b)), common = plan_area(difference(a, b));
    EXPECT_NEAR(whole + common, plan_area(a) + plan_area(b), 1e-11 * whole);
  }
}

TEST(Algebra, TranslationChangesNothing) {
  const auto [a, b] = pairs()[1];
  const double shift = 8192;  // with coordinates in 64ths: no bit is lost
  Tin exact_a = a, exact_b = b;
  for (Tin* tin : {&exact_a, &exact_b})
    for (Point& p : tin->vertices) p.x = std::round(p.x * 64) / 64, p.y = std::round(p.y * 64) / 64;
  const Tin here = sum(support::without_bad_faces(exact_a), support::without_bad_faces(exact_b));
  const Tin there = sum(support::without_bad_faces(support::shifted(exact_a, shift, -shift)),
                        support::without_bad_faces(support::shifted(exact_b, shift, -shift)));
  EXPECT_EQ(here.vertices.size(), there.vertices.size());
  EXPECT_EQ(here.faces.size(), there.faces.size());
  const Sampler z(here), moved(there);
  for (const Point2 p : random_places(bounds(here), 1000, 4)) {
    const double expected = z(p), got = moved({p.x + shift, p.y - shift});
    if (!std::isnan(expected) && !std::isnan(got)) {
      EXPECT_NEAR(got, expected, 1e-6);
    }
  }
}

/// Four windows of one terrain that overlap in a cross, each a little different.
std::vector<Tin> windows() {
  std::vector<Tin> tiles;
  for (int i = 0; i < 4; ++i) {
    const Tin whole = support::random_terrain(400, 10 + i);
    tiles.push_back(support::shifted(whole, (i % 2) * 8000.0, (i / 2) * 8500.0));
  }
  return tiles;
}

double median(std::vector<double> z) {
  std::sort(z.begin(), z.end());
  return (z[(z.size() - 1) / 2] + z[z.size() / 2]) / 2;
}

TEST(MergeLaws, HeightsFollowThePolicyEverywhere) {
  const std::vector<Tin> tiles = windows();
  std::vector<Sampler> samplers;
  for (const Tin& tile : tiles) samplers.emplace_back(tile);
  for (const Overlap policy :
       {Overlap::first, Overlap::last, Overlap::mean, Overlap::median, Overlap::min, Overlap::max, Overlap::sum}) {
    const Tin tin = merged(tiles, policy).surface.tin;
    EXPECT_EQ(wrong_with(tin), "");
    EXPECT_EQ(open_seams(tin), "");
    const Sampler z(tin);
    for (const Point2 p : random_places(bounds(tin), 4000, 6)) {
      std::vector<double> heights;
      for (const Sampler& s : samplers)
        if (const double h = s(p); !std::isnan(h)) heights.push_back(h);
      EXPECT_EQ(heights.empty(), std::isnan(z(p)));
      if (heights.empty()) continue;
      double total = 0;
      for (const double h : heights) total += h;
      const double wanted = policy == Overlap::first    ? heights.front()
                            : policy == Overlap::last   ? heights.back()
                            : policy == Overlap::min    ? *std::min_element(heights.begin(), heights.end())
                            : policy == Overlap::max    ? *std::max_element(heights.begin(), heights.end())
                            : policy == Overlap::mean   ? total / static_cast<double>(heights.size())
                            : policy == Overlap::median ? median(heights)
                                                        : total;
      EXPECT_NEAR(z(p), wanted, 1e-6);
    }
  }
}

TEST(MergeLaws, TheMedianOfTwoIsTheirMeanAndOfThreeLiesBetweenMinAndMax) {
  const Tin a = support::random_terrain(200, 1), b = support::random_terrain(200, 2),
            c = support::random_terrain(200, 3);
  const Sampler mean(merged({a, b}, Overlap::mean).surface.tin), two(merged({a, b}, Overlap::median).surface.tin);
  const Sampler low(merged({a, b, c}, Overlap::min).surface.tin), high(merged({a, b, c}, Overlap::max).surface.tin);
  const Sampler middle(merged({a, b, c}, Overlap::median).surface.tin),
      all(merged({a, b, c}, Overlap::sum).surface.tin);
  for (const Point2 p : random_places(bounds(a), 2000, 8)) {
    EXPECT_NEAR(two(p), mean(p), 1e-6);
    EXPECT_NEAR(low(p) + middle(p) + high(p), all(p), 1e-6);
  }
}

TEST(MergeLaws, FirstIsLastBackwards) {
  std::vector<Tin> tiles = windows();
  const Tin first = merged(tiles, Overlap::first).surface.tin;
  std::reverse(tiles.begin(), tiles.end());
  EXPECT_EQ(merged(tiles, Overlap::last).surface.tin, first);
}

TEST(MergeLaws, MinAndMaxAddUpToBoth) {
  const Tin a = support::random_terrain(300, 1), b = support::random_terrain(300, 2);
  const Tin low = merged({a, b}, Overlap::min).surface.tin, high = merged({a, b}, Overlap::max).surface.tin;
  const Tin both = sum(a, b), again = sum(low, high);
  const Sampler z(both), w(again), l(low), h(high);
  for (const Point2 p : random_places(bounds(a), 2000, 7)) {
    EXPECT_NEAR(z(p), w(p), 1e-6);
    EXPECT_LE(l(p), h(p) + 1e-9);
  }
}

TEST(MergeLaws, AMergeOfTheCutsIsTheOriginal) {
  const Tin whole = support::random_terrain(500, 8);
  std::vector<Tin> cuts;
  for (int i = 0; i < 4; ++i)
    cuts.push_back(support::without(whole, [i](Point2 c) { return (c.x > 4000) + 2 * (c.y > 6000) != i; }));
  for (const Overlap policy :
       {Overlap::first, Overlap::last, Overlap::mean, Overlap::median, Overlap::min, Overlap::max, Overlap::sum}) {
    const Merged result = merged(cuts, policy);
    EXPECT_EQ(result.surface.tin, whole);
    EXPECT_EQ(result.surface.wall_area, 0);
    for (const SeamPair& pair : result.seams) EXPECT_FALSE(pair.overlap);
  }
}

TEST(MergeLaws, AreaBalances) {
  const std::vector<Tin> tiles = windows();
  const double expected = plan_area(merged(tiles, Overlap::first).surface.tin);
  for (const Overlap policy : {Overlap::last, Overlap::mean, Overlap::median, Overlap::min, Overlap::max, Overlap::sum})
    EXPECT_NEAR(plan_area(merged(tiles, policy).surface.tin), expected, 1e-11 * expected);
}

TEST(MergeLaws, EveryJumpIsSomebodys) {
  const Merged result = merged(windows(), Overlap::mean);
  double walls = 0;
  for (const SeamPair& pair : result.seams) walls += pair.wall_area;
  EXPECT_NEAR(walls, result.surface.wall_area, 1e-6 * walls);
}

TEST(MergeLaws, ManyTilesWithBordersThatAlmostMeet) {
  std::vector<Tin> tiles;
  for (int i = 0; i < 9; ++i) {
    const Tin tile = support::jittered(support::random_terrain(100, 20 + i), 1e-9, true);
    tiles.push_back(
        support::without_bad_faces(support::shifted(tile, (i % 3) * support::side, (i / 3) * support::side)));
  }
  for (const Overlap policy : {Overlap::first, Overlap::mean, Overlap::max}) {
    const Tin tin = merged(tiles, policy).surface.tin;
    EXPECT_EQ(wrong_with(tin), "");
    EXPECT_EQ(open_seams(tin), "");
  }
}

}  // namespace
}  // namespace terrane
