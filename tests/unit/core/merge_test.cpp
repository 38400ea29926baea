// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/area_quantile.hpp"
#include "support/checks.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::drawn;
using support::open_seams;
using support::Sampler;
using support::wrong_with;

Merged merged(const std::vector<Tin>& tiles, Overlap overlap, Seam seam = Seam::wall, double z_tolerance = 0) {
  Context context;
  return merge(tiles, {overlap, {seam, z_tolerance}}, context);
}

const Tin west = drawn(
    "2222\n"
    "2222\n"
    "2222");
const Tin east = drawn(
    "5555\n"
    "5555\n"
    "5555",
    1, {2, 0});

TEST(Merge, EachPolicyOnTheOverlap) {
  const std::pair<Overlap, double> expected[] = {{Overlap::first, 2}, {Overlap::last, 5},   {Overlap::min, 2},
                                                 {Overlap::max, 5},   {Overlap::mean, 3.5}, {Overlap::sum, 7}};
  for (const auto& [policy, height] : expected) {
    const Tin tin = merged({west, east}, policy).surface.tin;
    const Sampler z(tin);
    EXPECT_EQ(z({2.4, 1.1}), height);
    EXPECT_EQ(z({1.4, 1.1}), 2);
    EXPECT_EQ(z({3.4, 1.1}), 5);
    EXPECT_EQ(wrong_with(tin), "");
    EXPECT_EQ(open_seams(tin), "");
  }
}

TEST(Merge, PasteLeavesTheUpperTileAsItIs) {
  const Tin fine = support::patch(2, 2, 5, 5, 0.7);
  const Tin coarse = support::patch(0, 0, 3, 3, 3, 20);
  const Tin tin = merged({fine, coarse}, Overlap::first).surface.tin;
  EXPECT_EQ(wrong_with(tin), "");
  EXPECT_EQ(support::missing_vertices(fine, tin), 0u);
  EXPECT_EQ(support::missing_vertices(coarse, tin), 1u) << "one vertex of the coarse tile lies under the fine one";
  const Sampler z(tin), of_fine(fine), of_coarse(coarse);
  for (const Point2 p : support::random_places({0, 0, 9, 9}, 2000, 1)) {
    const double wanted = std::isnan(of_fine(p)) ? of_coarse(p) : of_fine(p);
    EXPECT_NEAR(z(p), wanted, 1e-9);
  }
}

TEST(Merge, MinAndMaxAreSplitWhereSurfacesCross) {
  const Tin ramp = drawn("0369\n0369\n0369"), flat = drawn("4444\n4444\n4444");
  for (const Overlap policy : {Overlap::min, Overlap::max}) {
    const Tin tin = merged({ramp, flat}, policy).surface.tin;
    const Sampler z(tin), r(ramp);
    for (const Point2 p : support::random_places({0, 0, 3, 2}, 1000, 2))
      EXPECT_NEAR(z(p), policy == Overlap::max ? std::max(4.0, r(p)) : std::min(4.0, r(p)), 1e-12);
    EXPECT_EQ(wrong_with(tin), "");
    EXPECT_EQ(merged({ramp, flat}, policy).surface.wall_area, 0);
  }
}

TEST(Merge, ABorderIsMadeConformingAndNoHeightMoves) {
  const Tin coarse = drawn("a0a\n0a0\na0a", 3),
            fine = drawn("5150515\n1515151\n0515151\n5151515\n1515151\n5151515\n0515151", 1, {6, 0});
  const Merged result = merged({coarse, fine}, Overlap::mean);
  EXPECT_EQ(wrong_with(result.surface.tin), "");
  EXPECT_EQ(open_seams(result.surface.tin), "");
  EXPECT_EQ(support::missing_vertices(coarse, result.surface.tin), 0u);
  EXPECT_EQ(support::missing_vertices(fine, result.surface.tin), 0u);
  ASSERT_EQ(result.seams.size(), 1u);
  EXPECT_FALSE(result.seams[0].overlap);
  EXPECT_GT(result.seams[0].jump_count, 0u);
  EXPECT_NEAR(result.seams[0].wall_area, result.surface.wall_area, 1e-12);
}

TEST(Merge, EqualHeightsAlongABorderLeaveNoJump) {
  // The fine side's heights lie on the coarse side's edge but for rounding.
  const Tin coarse = support::patch(0, 0, 1, 1, 3), fine_flat = support::patch(3, 0, 9, 9, 1.0 / 3);
  const Sampler z(coarse);
  Tin fine = fine_flat;
  for (Point& p : fine.vertices)
    if (p.x == 3) {
      const double t = p.y / 3;
      p.z = z({3, 0}) * (1 - t) + z({3, 3}) * t;
    }
  const Merged result = merged({coarse, fine}, Overlap::first);
  EXPECT_EQ(result.surface.wall_area, 0);
  EXPECT_EQ(result.seams[0].jump_count, 0u);
  EXPECT_EQ(support::missing_vertices(coarse, result.surface.tin), 0u);
  EXPECT_EQ(support::missing_vertices(fine, result.surface.tin), 0u);
}

TEST(Merge, IslandsStayApart) {
  const Tin away = support::shifted(west, 10, 10);
  const Merged result = merged({west, away}, Overlap::first);
  EXPECT_EQ(result.surface.tin.faces.size(), west.faces.size() + away.faces.size());
  EXPECT_TRUE(result.seams.empty());
}

TEST(Merge, EmptyTilesAreTheIdentity) {
  EXPECT_TRUE(merged({}, Overlap::first).surface.tin.faces.empty());
  EXPECT_TRUE(merged({Tin{}, Tin{}}, Overlap::mean).surface.tin.faces.empty());
  EXPECT_EQ(merged({Tin{}, west, Tin{}}, Overlap::sum).surface.tin, west);
}

TEST(Merge, MeanOfEqualTilesIsTheTile) {
  const Tin tile = support::random_terrain(150, 4);
  for (const int count : {2, 3, 7}) EXPECT_EQ(merged(std::vector<Tin>(count, tile), Overlap::mean).surface.tin, tile);
}

TEST(Merge, ToleranceClosesAtTheTileThatGoesBefore) {
  const Tin a = drawn("22\n22"), b = support::shifted(a, 1, 0, 0.25);
  for (const auto& [policy, height] : {std::pair(Overlap::first, 2.0), std::pair(Overlap::last, 2.25)}) {
    const Merged result = merged({a, b}, policy, Seam::wall, 0.5);
    EXPECT_EQ(result.surface.wall_area, 0);
    EXPECT_EQ(result.surface.max_closed_jump, 0.25);
    for (const Point& p : result.surface.tin.vertices) {
      if (p.x == 1) {
        EXPECT_EQ(p.z, height);
      }
    }
  }
}

TEST(Seams, StatisticsOfAConstantBias) {
  const Merged result = merged({west, east}, Overlap::first);
  ASSERT_EQ(result.seams.size(), 1u);
  const SeamPair& pair = result.seams[0];
  EXPECT_EQ(pair.a, 0);
  EXPECT_EQ(pair.b, 1);
  EXPECT_TRUE(pair.overlap);
  EXPECT_DOUBLE_EQ(pair.overlap_area_2d, 2);
  EXPECT_DOUBLE_EQ(pair.dz_mean, 3);
  EXPECT_EQ(pair.dz_median, 3);
  EXPECT_DOUBLE_EQ(pair.dz_rmse, 3);
  EXPECT_EQ(pair.dz_nmad, 0);
  EXPECT_EQ(pair.dz_p95_abs, 3);
  EXPECT_EQ(pair.jump_max_abs, 3);
  EXPECT_DOUBLE_EQ(pair.jump_length_2d, 2);
  EXPECT_DOUBLE_EQ(pair.jump_mean_abs, 3);
  EXPECT_DOUBLE_EQ(pair.wall_area, 6);
}

TEST(Seams, SignFollowsTheOrderOfTiles) {
  EXPECT_DOUBLE_EQ(merged({east, west}, Overlap::first).seams[0].dz_mean, -3);
  EXPECT_DOUBLE_EQ(merged({east, west}, Overlap::max).seams[0].dz_mean, -3);
}

TEST(Seams, ARampHasTheQuantilesOfItsHeights) {
  const Tin ramp = drawn("048\n048\n048"), ground = drawn("000\n000\n000");
  const SeamPair pair = merged({ground, ramp}, Overlap::first).seams.at(0);
  EXPECT_NEAR(pair.dz_mean, 4, 1e-12);
  EXPECT_NEAR(pair.dz_median, 4, 1e-11);
  EXPECT_NEAR(pair.dz_rmse, std::sqrt(64 / 3.0), 1e-12);
  EXPECT_NEAR(pair.dz_nmad, 1.4826 * 2, 1e-10);
  EXPECT_NEAR(pair.dz_p95_abs, 7.6, 1e-11);
  EXPECT_EQ(pair.jump_count, 0u);
}

TEST(Seams, BiasIsSuspectedWhenNoiseCannotExplainIt) {
  const Tin tile = support::random_terrain(200, 5);
  EXPECT_TRUE(merged({tile, support::shifted(tile, 0, 0, 0.5)}, Overlap::mean).seams.at(0).bias_suspected);
  EXPECT_FALSE(merged({tile, tile}, Overlap::mean).seams.at(0).bias_suspected);
}

TEST(AreaQuantile, ClosedFormOnATriangle) {
  const LinearPiece piece{2, {0, 1, 4}};
  EXPECT_EQ(area_at_most(piece, -1), 0);
  EXPECT_EQ(area_at_most(piece, 4), 2);
  EXPECT_DOUBLE_EQ(area_at_most(piece, 1), 2 * 0.25);
  EXPECT_DOUBLE_EQ(area_at_most(piece, 0.5), 2 * 0.0625);
  EXPECT_DOUBLE_EQ(area_at_most(piece, 2.5), 2 * (1 - 0.25 * 0.75));
}

TEST(AreaQuantile, LevelAreasAreExact) {
  const std::vector<LinearPiece> pieces{{3, {0.1, 0.1, 0.1}}, {1, {0.1, 5, 7}}, {1, {9, 9, 9}}};
  EXPECT_EQ(area_quantile(pieces, 0.5), 0.1);
  EXPECT_EQ(area_quantile(pieces, 0.95), 9);
  EXPECT_EQ(area_quantile_abs(pieces, 0.1, 0.5), 0);
}

}  // namespace
}  // namespace terrane
