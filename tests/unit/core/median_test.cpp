// SPDX-License-Identifier: GPL-3.0-or-later

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/merge.hpp"
#include "support/checks.hpp"
#include "support/merge_judge.hpp"
#include "support/small_mesh.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::drawn;
using support::open_seams;
using support::Sampler;
using support::wrong_with;

Merged merged(const std::vector<Tin>& tiles, MergeOptions options) {
  Context context;
  return merge(tiles, options, context);
}

double median_of(std::vector<double> z) {
  std::sort(z.begin(), z.end());
  return (z[(z.size() - 1) / 2] + z[z.size() / 2]) / 2;
}

/// The largest difference from the median of the tiles at random places away from edges.
double worst(const Tin& result, const std::vector<Tin>& tiles, int count = 3000) {
  std::vector<Sampler> samplers(tiles.begin(), tiles.end());
  const Sampler z(result);
  double error = 0;
  for (const Point2 p : support::random_places(bounds(result), count, 9)) {
    std::vector<double> heights;
    bool clear = z.clear_of_edges(p, 1e-6);
    for (const Sampler& tile : samplers) {
      clear = clear && tile.clear_of_edges(p, 1e-6);
      if (const double h = tile(p); !std::isnan(h)) heights.push_back(h);
    }
    if (!clear) continue;
    if (heights.empty() != std::isnan(z(p))) return INFINITY;
    if (!heights.empty()) error = std::max(error, std::fabs(z(p) - median_of(heights)));
  }
  return error;
}

TEST(Median, OfFlatTiles) {
  const Tin a = drawn("1111\n1111\n1111"), b = drawn("5555\n5555\n5555", 1, {1, 0}),
            c = drawn("333\n333\n333", 1, {2, 0});
  const Tin tin = merged({a, b, c}, {Overlap::median, {}}).surface.tin;
  const Sampler z(tin);
  EXPECT_EQ(z({0.4, 1.1}), 1);
  EXPECT_EQ(z({1.4, 1.1}), 3) << "the mean of two";
  EXPECT_EQ(z({2.4, 1.1}), 3) << "the middle of three";
  EXPECT_EQ(z({3.4, 1.1}), 4);
  EXPECT_EQ(wrong_with(tin), "");
  EXPECT_EQ(open_seams(tin), "");
}

TEST(Median, IsSplitWhereTheMiddleChangesHands) {
  const Tin up = drawn("0369\n0369\n0369"), down = drawn("9630\n9630\n9630"), flat = drawn("4444\n4444\n4444");
  const Merged result = merged({up, down, flat}, {Overlap::median, {}});
  EXPECT_LT(worst(result.surface.tin, {up, down, flat}), 1e-12);
  EXPECT_EQ(result.surface.wall_area, 0);
  EXPECT_EQ(wrong_with(result.surface.tin), "");
}

TEST(Median, OfEqualTilesIsTheTile) {
  const Tin tile = support::random_terrain(150, 4);
  for (const int count : {1, 2, 3, 6})
    EXPECT_EQ(merged(std::vector<Tin>(count, tile), {Overlap::median, {}}).surface.tin, tile);
}

TEST(Median, OneOutlierHasNoSay) {
  const Tin tile = support::random_terrain(150, 4);
  const Tin far = support::shifted(tile, 0, 0, 1000);
  EXPECT_EQ(merged({far, tile, tile}, {Overlap::median, {}}).surface.tin, tile);
}

TEST(Median, OfRandomTerrainsIsExactAndTheSameInAnyOrder) {
  for (const int count : {3, 4, 5}) {
    std::vector<Tin> tiles;
    for (int i = 0; i < count; ++i) {
      Tin tile = support::random_terrain(120, 40 + static_cast<std::uint64_t>(i));
      if (i % 2 == 1) tile = support::shifted(tile, 137.5 * i, -211.25 * i);
      if (i == 2) tile = support::with_holes(tile);
      tiles.push_back(canonical(tile));
    }
    const Merged result = merged(tiles, {Overlap::median, {}});
    EXPECT_LT(worst(result.surface.tin, tiles), 1e-8);
    EXPECT_EQ(support::broken_promises(tiles, {Overlap::median, {}}, result), "");
    std::vector<int> order(tiles.size());
    std::iota(order.begin(), order.end(), 0);
    for (int turn = 0; turn < 5; ++turn) {
      std::next_permutation(order.begin(), order.end());
      if (turn % 2 == 1) std::reverse(order.begin(), order.end());
      std::vector<Tin> permuted;
      for (const int i : order) permuted.push_back(tiles[i]);
      EXPECT_EQ(merged(permuted, {Overlap::median, {}}).surface.tin, result.surface.tin) << count << " tiles";
    }
  }
}

TEST(Median, OfSmallMeshesFullOfSlivers) {
  support::Random random(77);
  for (int trial = 0; trial < 150; ++trial) {
    std::vector<Tin> tiles;
    const int count = 3 + support::below(random, 4);
    const double at = trial % 2 == 0 ? 0 : 500000;
    for (int i = 0; i < count; ++i) {
      std::vector<Point> points;
      for (int p = 0; p < 7; ++p)
        points.push_back(
            {at + support::below(random, 9), at + support::below(random, 9), 1.0 * support::below(random, 5)});
      const Tin tile = support::swept(points);
      if (!tile.faces.empty()) tiles.push_back(canonical(support::flipped(tile, 4, random)));
    }
    if (tiles.empty()) continue;
    const MergeOptions options{Overlap::median, {}};
    EXPECT_EQ(support::broken_promises(tiles, options, merged(tiles, options)), "") << "trial " << trial;
  }
}

TEST(Median, ASliverThatRisesLittleAlongItsEdgesLiftsNoTerrain) {
  // The sliver rises 2e9 metres per metre, but less than the steep tile along the edges that are cut where they cross.
  const Tin sliver{{{333333.3513142431, 5000001.307302013, 3.06},
                    {333333.78480749601, 5000001.2036332469, 2},
                    {333333.98994119535, 5000001.1545760669, -2.9721865244553709}},
                   {{0, 1, 2}}};
  const Tin gentle{{{333333.50100766728, 5000000.9974581236, -3.4},
                    {333333.63305522659, 5000001.4345699931, 4.9},
                    {333333.77257915505, 5000001.1036312189, -1}},
                   {{0, 2, 1}}};
  const Tin steep{{{333333.65363031212, 5000001.120658841, 40},
                   {333333.57512176642, 5000001.3171156533, 160.90096246920777},
                   {333333.80993051408, 5000001.375, -138.4}},
                  {{0, 2, 1}}};
  const std::vector<Tin> tiles{canonical(sliver), canonical(gentle), canonical(steep)};
  const MergeOptions options{Overlap::median, {}};
  EXPECT_EQ(support::broken_promises(tiles, options, merged(tiles, options)), "");
}

TEST(Median, ACutThatRoundingUndoesKeepsNoOtherFromBeingMade) {
  // Along the sliver all three cross, two of them where it is too thin for their cut.
  const Tin sliver{{{333333.3513142431, 5000001.307302013, 2.6},
                    {333333.78480749601, 5000001.2036332469, 0.71014970264488875},
                    {333333.98994119535, 5000001.1545760669, -4}},
                   {{0, 1, 2}}};
  const Tin gentle{{{333333.6990259313, 5000001.0810913453, -1.1003594088182831},
                    {333333.73014068604, 5000001.125, -1},
                    {333333.63153076172, 5000001.4375, 1.4}},
                   {{0, 1, 2}}};
  const Tin steep{{{333333.56648366008, 5000001.2325808052, 181.8385447753252},
                   {333333.76245117188, 5000001.3178895684, -130},
                   {333333.689453125, 5000001.080078125, 43.195747988370428}},
                  {{0, 2, 1}}};
  const std::vector<Tin> tiles{canonical(sliver), canonical(gentle), canonical(steep)};
  const MergeOptions options{Overlap::median, {}};
  EXPECT_EQ(support::broken_promises(tiles, options, merged(tiles, options)), "");
}

TEST(Level, CutsOffWhatLiesBeyondIt) {
  const Tin ramp = drawn("0369\n0369\n0369"), east = drawn("222\n222\n222", 1, {3, 0});
  for (const auto policy : {Overlap::min, Overlap::max}) {
    const Merged result = merged({ramp, east}, {policy, {}, 4.5});
    const Sampler z(result.surface.tin), r(ramp);
    for (const Point2 p : support::random_places({0, 0, 5, 2}, 1000, 2)) {
      if (!z.clear_of_edges(p, 1e-9)) continue;
      const double ground = p.x < 3 ? r(p) : 2;
      EXPECT_NEAR(z(p), policy == Overlap::max ? std::max(ground, 4.5) : std::min(ground, 4.5), 1e-12);
    }
    EXPECT_EQ(wrong_with(result.surface.tin), "");
    EXPECT_EQ(open_seams(result.surface.tin), "");
  }
}

TEST(Level, OfOneTileOnly) {
  const Tin ramp = drawn("0369\n0369\n0369");
  EXPECT_EQ(merged({ramp}, {Overlap::max, {}, -1}).surface.tin, ramp);
  for (const Point& p : merged({ramp}, {Overlap::max, {}, 20}).surface.tin.vertices) EXPECT_EQ(p.z, 20);
}

}  // namespace
}  // namespace terrane
