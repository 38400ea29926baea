// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/surface.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "support/checks.hpp"
#include "support/oracle.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::open_seams;
using support::wrong_with;

/// Two unit squares side by side, each of two faces, sharing the edge from (1, 0) to (1, 1):
///
///    3---4---5      heights of the left square: l everywhere but on the shared edge,
///    | / | / |      where it is `left` (bottom, top); of the right likewise.
///    0---1---2
CornerSurface two_squares(Point2 left, Point2 right, double l = 0, double r = 0) {
  CornerSurface surface;
  surface.points = {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}};
  surface.faces = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
  surface.z = {l, left.x, left.y, l, left.y, l, right.x, r, r, right.x, r, right.y};
  return surface;
}

std::size_t walls(const Tin& tin) {
  std::size_t count = 0;
  for (const Face& f : tin.faces) count += is_wall(tin, f);
  return count;
}

Assembled assembled(CornerSurface surface, Seam seam = Seam::wall, double z_tolerance = 0) {
  Context context;
  return assemble(std::move(surface), {seam, z_tolerance}, context);
}

TEST(Assemble, EqualHeightsNeedNoWall) {
  const Assembled result = assembled(two_squares({3, 4}, {3, 4}));
  EXPECT_EQ(result.tin.vertices.size(), 6u);
  EXPECT_EQ(result.tin.faces.size(), 4u);
  EXPECT_EQ(result.wall_area, 0);
  EXPECT_EQ(wrong_with(result.tin), "");
}

TEST(Assemble, JumpAtBothEndsIsAWallOfTwoFaces) {
  const Assembled result = assembled(two_squares({1, 2}, {5, 4}));
  EXPECT_EQ(walls(result.tin), 2u);
  EXPECT_EQ(result.tin.vertices.size(), 8u);
  EXPECT_DOUBLE_EQ(result.wall_area, 3);
  EXPECT_EQ(wrong_with(result.tin), "");
  EXPECT_EQ(open_seams(result.tin), "");
}

TEST(Assemble, JumpAtOneEndIsAWallOfOneFace) {
  const Assembled result = assembled(two_squares({1, 2}, {5, 2}));
  EXPECT_EQ(walls(result.tin), 1u);
  EXPECT_EQ(result.tin.vertices.size(), 7u);
  EXPECT_DOUBLE_EQ(result.wall_area, 2);
  EXPECT_EQ(open_seams(result.tin), "");
}

TEST(Assemble, WhereAJumpChangesSignTheZeroPointIsAVertex) {
  // dz is -1 at the bottom and 3 at the top: zero at a quarter of the edge.
  const Assembled result = assembled(two_squares({1, 5}, {2, 2}));
  EXPECT_EQ(walls(result.tin), 2u);
  const Point zero{1, 0.25, 2};
  EXPECT_NE(std::find(result.tin.vertices.begin(), result.tin.vertices.end(), zero), result.tin.vertices.end());
  EXPECT_EQ(result.tin.faces.size(), 4u + 2u + 2u);
  EXPECT_DOUBLE_EQ(result.wall_area, 0.5 * 0.25 * 1 + 0.5 * 0.75 * 3);
  EXPECT_EQ(wrong_with(result.tin), "");
  EXPECT_EQ(open_seams(result.tin), "");
}

TEST(Assemble, SplitLeavesTheSeamOpen) {
  const Assembled result = assembled(two_squares({1, 2}, {5, 4}), Seam::split);
  EXPECT_EQ(walls(result.tin), 0u);
  EXPECT_EQ(result.tin.vertices.size(), 8u);
  EXPECT_EQ(result.wall_area, 0);
  EXPECT_NE(open_seams(result.tin), "");
}

TEST(Assemble, RoundingIsWelded) {
  const double z = 1234.5;
  const Assembled result = assembled(two_squares({z, z}, {z * (1 + 1e-13), z * (1 - 1e-13)}, z, z));
  EXPECT_EQ(walls(result.tin), 0u);
  EXPECT_EQ(result.tin.vertices.size(), 6u);
  EXPECT_GT(result.max_closed_jump, 0);
  EXPECT_LT(result.max_closed_jump, 1e-9);
}

TEST(Assemble, WeldingKeepsFirmHeights) {
  const double z = 10, off = 10 + 1e-12;
  CornerSurface surface = two_squares({off, off}, {z, z}, 0, 0);
  surface.firm = {1, 0, 0, 1, 0, 1, 1, 1, 1, 1, 1, 1};
  const Tin tin = assembled(surface).tin;
  for (const Point& p : tin.vertices)
    if (p.x == 1) {
      EXPECT_EQ(p.z, z);
    }
}

TEST(Assemble, ToleranceClosesAtTheFirstFacesHeight) {
  const Assembled result = assembled(two_squares({1, 2}, {1.25, 3}), Seam::wall, 0.5);
  EXPECT_EQ(result.max_closed_jump, 0.25);
  EXPECT_EQ(walls(result.tin), 1u);
  for (const Point& p : result.tin.vertices)
    if (p.x == 1 && p.y == 0) {
      EXPECT_EQ(p.z, 1);
    }
  EXPECT_EQ(open_seams(result.tin), "");
}

TEST(Assemble, ToleranceMovesNoHeightFurtherThanItself) {
  // Steps of 0.4 around one place must not slide into each other.
  CornerSurface surface;
  surface.points = {{0, 0}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  surface.faces = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
  for (int f = 0; f < 4; ++f) surface.z.insert(surface.z.end(), 3, 0.4 * f);
  const Assembled result = assembled(surface, Seam::wall, 0.5);
  EXPECT_LE(result.max_closed_jump, 0.5);
  EXPECT_GT(walls(result.tin), 0u);
  EXPECT_EQ(open_seams(result.tin), "");
}

TEST(Assemble, WallsAreCutAtEveryHeightOfTheirPlaces) {
  // Four faces around a place at heights 0, 5, 10, 5: the wall from 10 to 0 passes 5.
  CornerSurface surface;
  surface.points = {{0, 0}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  surface.faces = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
  for (const double z : {0.0, 5.0, 10.0, 7.0}) surface.z.insert(surface.z.end(), 3, z);
  const Tin tin = assembled(surface).tin;
  EXPECT_EQ(wrong_with(tin), "");
  EXPECT_EQ(open_seams(tin), "");
  for (const Face& f : tin.faces)
    for (int k = 0; k < 3; ++k) {
      const Point &u = tin.vertices[f[k]], &v = tin.vertices[f[(k + 1) % 3]];
      if (!(plan(u) == plan(v))) continue;
      for (const Point& w : tin.vertices)
        if (plan(w) == plan(u)) {
          EXPECT_FALSE(w.z > std::min(u.z, v.z) && w.z < std::max(u.z, v.z));
        }
    }
}

TEST(Assemble, BytesDoNotDependOnTheOrderOfFaces) {
  CornerSurface surface = two_squares({1, 5}, {2, 2}, 3, 7), turned = surface;
  turned.faces.clear();
  turned.z.clear();
  for (const int f : {3, 1, 0, 2})
    for (int k = 0; k < 3; ++k) {
      if (k == 0) turned.faces.push_back({surface.faces[f][1], surface.faces[f][2], surface.faces[f][0]});
      turned.z.push_back(surface.z[3 * f + (k + 1) % 3]);
    }
  EXPECT_EQ(assembled(surface).tin, assembled(turned).tin);
}

TEST(Assemble, PiecesThatTouchInAPlaceShareItsVertex) {
  CornerSurface surface;
  surface.points = {{0, 0}, {1, 0}, {1, 1}, {-1, 0}, {-1, -1}};
  surface.faces = {{0, 1, 2}, {0, 3, 4}};
  surface.z = {1, 1, 1, 1, 1, 1};
  EXPECT_EQ(assembled(surface).tin.vertices.size(), 5u);
}

TEST(Assemble, SurfacesThatCrossBesideTheTipOfAThinFaceMeetThere) {
  // The first face falls by metres across its width of an ulp; at its tip the others are apart the other way.
  CornerSurface surface;
  surface.points = {{333338.18262402015, 5000003.6321341991},
                    {333338.18262288196, 5000003.6321329968},
                    {333338.18262288114, 5000003.6321329959},
                    {333338.1826228943, 5000003.6321330098},
                    {333338.18262281414, 5000003.6321329251}};
  surface.faces = {{0, 1, 2}, {0, 3, 1}, {0, 2, 4}};
  surface.z = {-164.92187102373083, -164.62965440904196, -168.04728675921442,
               -164.92166318871989, -164.92046930972796, -164.92101070305137,
               -164.92187102373083, -164.924323432666,   -164.92446769463857};
  const Assembled result = assembled(surface);
  EXPECT_EQ(wrong_with(result.tin), "");
  EXPECT_EQ(open_seams(result.tin), "");
  EXPECT_NEAR(bounds(result.tin).xmax, surface.points[0].x, 1e-8);
}

TEST(Assemble, NothingBecomesNothing) { EXPECT_TRUE(assembled({}).tin.faces.empty()); }

TEST(Assemble, WhatCouldNotBeRampedGetsWalls) {
  EXPECT_EQ(assembled(two_squares({1, 2}, {5, 4}), Seam::ramp).tin,
            assembled(two_squares({1, 2}, {5, 4}), Seam::wall).tin);
}

Overlay crossing(const char* a, const char* b) {
  Context context;
  return split_where_surfaces_cross(support::oracle_overlay(support::drawn(a), support::drawn(b)), context);
}

void expect_sorted(const Overlay& overlay) {
  for (Index f = 0; f < static_cast<Index>(overlay.faces.size()); ++f) {
    bool above = false, below = false;
    for (int k = 0; k < 3; ++k) {
      above |= overlay.height(0, f, k) > overlay.height(1, f, k);
      below |= overlay.height(0, f, k) < overlay.height(1, f, k);
    }
    EXPECT_FALSE(above && below) << "face " << f;
  }
}

TEST(ZeroLines, FacesAreCutWhereSurfacesCross) {
  const Overlay overlay = crossing("000\n000\n000", "103\n103\n103");
  EXPECT_EQ(overlay.faces.size(), 8u) << "only touching along x = 1: nothing to cut";
  const Overlay cut = crossing("111\n111\n111", "003\n003\n003");
  EXPECT_GT(cut.faces.size(), 8u);
  expect_sorted(cut);
  for (std::size_t v = 0; v < cut.points.size(); ++v)
    if (cut.points[v].x > 1 && cut.points[v].x < 2) {
      EXPECT_EQ(cut.heights[0][v], cut.heights[1][v]);
    }
}

TEST(ZeroLines, ThroughACorner) {
  const Overlay cut = crossing("11\n11", "12\n01");  // dz = 0 at two opposite corners, along the diagonal or across it
  expect_sorted(cut);
  const Overlay other = crossing("11\n11", "21\n10");
  expect_sorted(other);
}

TEST(ZeroLines, WholeFacesEqual) {
  const Overlay cut = crossing("111\n111", "111\n111");
  EXPECT_EQ(cut.faces.size(), 4u);
}

TEST(ZeroLines, OfRandomTerrains) {
  const Tin a = support::random_terrain(200, 1), b = support::random_terrain(220, 2);
  Context context;
  const Overlay before = support::oracle_overlay(a, b);
  const Overlay cut = split_where_surfaces_cross(before, context);
  EXPECT_GT(cut.faces.size(), before.faces.size());
  expect_sorted(cut);
  CornerSurface flat;
  flat.points = cut.points;
  flat.faces = cut.faces;
  flat.z.assign(3 * cut.faces.size(), 0);
  EXPECT_EQ(wrong_with(assemble(flat, {}, context).tin), "");
}

TEST(ZeroLines, SidesOfAJumpCrossAtTheirOwnPlaces) {
  // A jumps along x = 1 (left 0, right 1); B rises along y from -1 to 3 and crosses each side elsewhere.
  Tin a;
  a.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 1}, {2, 0, 1}, {2, 1, 1}, {1, 1, 1}};
  a.faces = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  Tin b;
  b.vertices = {{0, 0, -1}, {2, 0, -1}, {2, 1, 3}, {0, 1, 3}};
  b.faces = {{0, 1, 2}, {0, 2, 3}};
  const Overlay before = support::oracle_overlay(a, b);
  ASSERT_TRUE(before.per_corner[0]);
  Context context;
  const Overlay cut = split_where_surfaces_cross(before, context);
  expect_sorted(cut);
  int on_seam = 0;
  for (const Point2& p : cut.points) on_seam += p.x == 1 && (p.y == 0.25 || p.y == 0.5);
  EXPECT_EQ(on_seam, 2);
  CornerSurface flat{cut.points, cut.faces, std::vector<double>(3 * cut.faces.size(), 0)};
  EXPECT_EQ(wrong_with(assemble(flat, {}, context).tin), "");
}

}  // namespace
}  // namespace terrane
