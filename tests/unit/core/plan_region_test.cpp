// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/plan_region.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.hpp"
#include "core/plan/noding.hpp"
#include "core/plan/region_cells.hpp"
#include "core/volume.hpp"
#include "support/checks.hpp"
#include "support/clip_checks.hpp"
#include "support/polygons.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::ring;

PlanRegion region(const std::vector<Polygon>& polygons) { return plan_region(polygons, Context{}); }

Polygon box(double x0, double y0, double x1, double y1) { return {ring({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}), {}}; }

TEST(PlanRegion, OrientationSaysNothing) {
  Polygon frame = box(0, 0, 10, 10);
  frame.holes.push_back(box(2, 2, 4, 4).outer);
  Polygon turned = frame;
  std::reverse(turned.outer.begin(), turned.outer.end());
  EXPECT_EQ(region({frame}).tin, region({turned}).tin);
  std::reverse(turned.holes[0].begin(), turned.holes[0].end());
  EXPECT_EQ(region({frame}).tin, region({turned}).tin);
  EXPECT_DOUBLE_EQ(plan_area(region({frame}).tin), 96);
}

TEST(PlanRegion, RingsMayRepeatTheirFirstCorner) {
  Polygon closed = box(0, 0, 3, 3);
  closed.outer.push_back(closed.outer.front());
  EXPECT_EQ(region({closed}).tin, region({box(0, 0, 3, 3)}).tin);
}

TEST(PlanRegion, PolygonsAreUnitedAndSharedBordersVanish) {
  const PlanRegion both = region({box(0, 0, 1, 1), box(1, 0, 2, 1)});
  EXPECT_EQ(both.tin.faces.size(), 4u);  // six corners: those of the shared side lie on the border
  EXPECT_EQ(both.border.size(), 6u);
  const PlanRegion crossing = region({box(0, 0, 2, 2), box(1, 1, 3, 3)});
  EXPECT_DOUBLE_EQ(plan_area(crossing.tin), 7);
  EXPECT_FALSE(crossing.self_crossing);
  EXPECT_EQ(region({box(0, 0, 2, 2), box(0, 0, 2, 2)}).tin, region({box(0, 0, 2, 2)}).tin);
  EXPECT_DOUBLE_EQ(plan_area(region({box(0, 0, 4, 4), box(1, 1, 2, 2)}).tin), 16);
}

TEST(PlanRegion, AHoleIsCutFromItsOwnPolygonOnly) {
  Polygon frame = box(0, 0, 10, 10);
  frame.holes.push_back(box(2, 2, 8, 8).outer);
  EXPECT_DOUBLE_EQ(plan_area(region({frame, box(3, 3, 5, 5)}).tin), 68);
  frame.holes.push_back(box(6, 6, 12, 9).outer);  // partly beyond the outer ring and across another hole
  EXPECT_DOUBLE_EQ(plan_area(region({frame}).tin), 100 - 36 - (4 * 3 - 2 * 2));
}

TEST(PlanRegion, ABowTieIsWhatLiesInsideByParityAndSaysWhereItCrosses) {
  const PlanRegion tie = region({{ring({{0, 0}, {2, 2}, {2, 0}, {0, 2}}), {}}});
  ASSERT_TRUE(tie.self_crossing);
  EXPECT_EQ(*tie.self_crossing, (Point2{1, 1}));
  EXPECT_DOUBLE_EQ(plan_area(tie.tin), 2);
  EXPECT_FALSE(region({{ring({{0, 0}, {2, 0}, {1, 1}, {2, 2}, {0, 2}, {1, 1}}), {}}}).self_crossing);  // it touches
}

TEST(PlanRegion, RingsWithoutAreaAreNothing) {
  EXPECT_TRUE(region({}).empty());
  EXPECT_TRUE(region({{ring({{0, 0}, {1, 1}}), {}}}).empty());
  EXPECT_TRUE(region({{ring({{0, 0}, {1, 1}, {2, 2}}), {}}}).empty());
  EXPECT_TRUE(region({{ring({{5, 5}, {5, 5}, {5, 5}}), {}}}).empty());
  EXPECT_TRUE(region({{{}, {}}}).empty());
}

TEST(PlanRegion, CornersThatAreNoNumbersAreNamed) {
  try {
    region({box(0, 0, 1, 1), {ring({{0, 0}, {1, 0}, {std::nan(""), 1}}), {}}});
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("corner 2 of polygon 1"), std::string::npos) << e.what();
  }
}

TEST(PlanRegion, RandomUnionsHaveTheAreaThatGeosGives) {
  support::Random random(5);
  for (int round = 0; round < 60; ++round) {
    std::vector<Polygon> polygons;
    double area = 0;
    std::vector<std::vector<Point2>> rings;
    for (int i = 0; i < 6; ++i) {
      const Point2 centre{support::uniform(random, 0, 100), support::uniform(random, 0, 100)};
      polygons.push_back({support::star(centre, 5, 40, 3 + support::below(random, 30), random), {}});
    }
    // The union by inclusion and exclusion would need all subsets; a surface cut by them one by one does as well.
    Context context;
    Tin rest = support::grid_terrain(1, true);
    for (Point& p : rest.vertices) p.x = p.x / 50 - 50, p.y = p.y / 50 - 50;
    rest = canonical(rest);
    const double whole = plan_area(rest);
    for (const Polygon& p : polygons) {
      rings = {{}};
      for (const Point& c : p.outer) rings[0].push_back(plan(c));
      const auto geos = support::Polygons::from_rings(rings);
      area = plan_area(rest);
      const double shared = geos.shared_area(support::Polygons::from_domain(rest));
      rest = clip(rest, region({p}), Side::outside, context).tin;
      EXPECT_NEAR(plan_area(rest), area - shared, 1e-8 * whole);
    }
    const PlanRegion all = region(polygons);
    EXPECT_EQ(support::wrong_with(all.tin), "");
    EXPECT_NEAR(plan_area(all.tin), whole - plan_area(rest), 1e-9 * whole);
    for (const Point2 p : support::random_places({-20, -20, 120, 120}, 200, round))
      if (!support::near_border(polygons, p, 1e-6)) {
        EXPECT_EQ(side_of(all, p) > 0, support::inside(polygons, p));
      }
  }
}

TEST(PlanRegion, SideOfIsExact) {
  const PlanRegion square = region({box(0, 0, 2, 2)});
  EXPECT_EQ(side_of(square, {1, 1}), 1);
  for (const Point2 p : std::vector<Point2>{{0, 0}, {2, 2}, {1, 0}, {2, 1}, {0, 2}}) EXPECT_EQ(side_of(square, p), 0);
  EXPECT_EQ(side_of(square, {std::nextafter(2, 3), 1}), -1);
  EXPECT_EQ(side_of(square, {3, 2}), -1);
  EXPECT_EQ(side_of(square, {-1, 0}), -1);
}

TEST(Noding, EdgesMeetAtTheirEndsOnly) {
  support::Random random(6);
  for (const double at : {0.0, 500000.0}) {
    std::vector<Point2> points;
    std::vector<NodedEdge> edges;
    for (Index i = 0; i < 60; ++i) {  // small whole numbers: three through one place, collinear overlaps
      for (int k = 0; k < 2; ++k) points.push_back({at + support::below(random, 12), at + support::below(random, 12)});
      edges.push_back({2 * i, 2 * i + 1, i});
    }
    const Noded noded = node_edges(points, edges, Context{});
    EXPECT_TRUE(find_crossings(noded.points, noded.edges, 10, Context{}).empty());
    EXPECT_GT(noded.edges.size(), 300u);
  }
}

Polygon circle(double x, double radius, int corners) {
  Polygon made;
  for (int k = 0; k < corners; ++k)
    made.outer.push_back({x + radius * std::cos(2 * M_PI * k / corners), radius * std::sin(2 * M_PI * k / corners), 0});
  return made;
}

TEST(Noding, ManyRingsInOnePlaceAreComparedOnce) {
  // Every edge of one beside every edge of the others took minutes.
  const Polygon one = circle(0, 10, 90);
  EXPECT_EQ(region(std::vector<Polygon>(20000, one)).tin, region({one}).tin);
}

TEST(Noding, PiecesCrowdWhereEdgesCrossAndAreFoundQuickly) {
  // Half a million crossings near a circle of a thousandth of the size: in few cells.
  Polygon star;
  for (int k = 0; k < 999; ++k)
    star.outer.push_back({40 * std::cos(k * 499 * 2 * M_PI / 999), 40 * std::sin(k * 499 * 2 * M_PI / 999), 0});
  EXPECT_GT(region({star}).tin.faces.size(), 400'000u);
}

TEST(Noding, SpikesSideBySideAreNotComparedWithEachOther) {
  // 200 million pairs, had each edge to be held against all that are near it.
  constexpr int corners = 20000;
  Polygon star;
  for (int k = 0; k < corners; ++k) {
    const double radius = k % 2 ? 5000 : 1;
    star.outer.push_back({radius * std::cos(2 * M_PI * k / corners), radius * std::sin(2 * M_PI * k / corners), 0});
  }
  const PlanRegion all = region({star});
  EXPECT_EQ(all.tin.faces.size(), corners - 2u);
  EXPECT_FALSE(all.self_crossing);
  // One that crosses others is found among them all the same.
  star.outer.resize(corners / 10);
  std::swap(star.outer[501], star.outer[505]);
  EXPECT_TRUE(region({star}).self_crossing);
}

TEST(Noding, WhatLiesTooCloseIsRefusedInTime) {
  std::vector<Polygon> rings;
  for (int k = 0; k < 20000; ++k) rings.push_back(circle(k % 2 * 1e-8, 10 + k * 1e-9, 90));
  try {
    region(rings);
    ADD_FAILURE() << "compared all";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, "too-many-crossings");
  }
}

TEST(RegionCells, NeverTakeTheWrongSide) {
  support::Random random(7);
  for (int round = 0; round < 30; ++round) {
    const double at = round % 2 ? 5e6 : 0, size = round % 3 ? 100 : 1e-3;
    std::vector<Polygon> polygons = {
        {support::star({at, at}, 0.2 * size, size, 4 + support::below(random, 40), random), {}}};
    const PlanRegion all = region(polygons);
    for (const std::size_t count : {0u, 500u, 200000u}) {
      // The whole of it, or a window.
      const Box within = count == 500u ? Box{at - 0.4 * size, at - 0.3 * size, at + 2 * size, at + 0.6 * size}
                                       : Box{at - 2 * size, at - 2 * size, at + 2 * size, at + 2 * size};
      const RegionCells cells(all, within, count);
      for (int i = 0; i < 300; ++i) {
        const Point2 p{at + support::uniform(random, -1.2, 1.2) * size,
                       at + support::uniform(random, -1.2, 1.2) * size};
        const double w = support::uniform(random, 0, 0.1) * size;
        if (p.x < within.xmin || p.y < within.ymin || p.x + w > within.xmax || p.y + w > within.ymax) continue;
        const auto where = cells({p.x, p.y, p.x + w, p.y + w});
        if (where == RegionCells::Where::near) continue;
        for (const Point2 q : std::vector<Point2>{p, {p.x + w, p.y}, {p.x, p.y + w}, {p.x + w, p.y + w}})
          EXPECT_EQ(side_of(all, q), where == RegionCells::Where::inside ? 1 : -1);
      }
    }
  }
}

}  // namespace
}  // namespace terrane
