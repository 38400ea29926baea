// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/clip.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>
#include <vector>

#include "core/merge.hpp"
#include "core/validate.hpp"
#include "core/volume.hpp"
#include "support/checks.hpp"
#include "support/clip_checks.hpp"
#include "support/exact.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::drawn;
using support::ring;
using support::wrong_with_clips;

Clipped clipped(const Tin& tin, const std::vector<Polygon>& polygons, Side side) {
  Context context;
  return clip(tin, plan_region(polygons, context), side, context);
}

Tin inside(const Tin& tin, const std::vector<Polygon>& polygons) { return clipped(tin, polygons, Side::inside).tin; }
Tin outside(const Tin& tin, const std::vector<Polygon>& polygons) { return clipped(tin, polygons, Side::outside).tin; }

Polygon box(double x0, double y0, double x1, double y1) { return {ring({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}), {}}; }

mpq_class exact_area(const Tin& tin) {
  mpq_class sum = 0;
  for (const Face& f : tin.faces)
    sum += support::area2_exact(plan(tin.vertices[f[0]]), plan(tin.vertices[f[1]]), plan(tin.vertices[f[2]]));
  return sum;
}

const Tin hill = drawn(
    "11111\n"
    "12321\n"
    "13531\n"
    "12321\n"
    "11111");

TEST(Clip, ABoxAlongMeshEdgesTakesWholeFaces) {
  const Clipped result = clipped(hill, {box(1, 1, 3, 3)}, Side::inside);
  EXPECT_EQ(result.cut, 0u);
  EXPECT_EQ(result.tin, support::without(hill, [](Point2 c) { return c.x < 1 || c.x > 3 || c.y < 1 || c.y > 3; }));
  EXPECT_EQ(wrong_with_clips(hill, {box(1, 1, 3, 3)}), "");
}

TEST(Clip, CutFacesKeepTheirPlane) {
  const Tin in = inside(hill, {box(0.25, 0.5, 3.5, 3.25)});
  EXPECT_EQ(support::wrong_with(in), "");
  EXPECT_DOUBLE_EQ(plan_area(in), 3.25 * 2.75);
  const support::Sampler z(hill);
  for (const Point& p : in.vertices) EXPECT_NEAR(p.z, z(plan(p)), 1e-12);
  EXPECT_EQ(wrong_with_clips(hill, {box(0.25, 0.5, 3.5, 3.25)}), "");
}

TEST(Clip, RegionInsideOneFaceGetsItsHeightsFromThePlane) {
  const Tin ramp = drawn(
      "0369\n"
      "0369",
      4);
  const std::vector<Polygon> small = {{ring({{1.5, 0.25}, {2.5, 0.25}, {2.5, 0.75}}), {}}};
  const Clipped result = clipped(ramp, small, Side::inside);
  EXPECT_EQ(result.tin.faces.size(), 1u);
  EXPECT_EQ(result.cut, 1u);
  for (const Point& p : result.tin.vertices) EXPECT_DOUBLE_EQ(p.z, 0.75 * p.x);
  EXPECT_EQ(wrong_with_clips(ramp, small), "");
}

TEST(Clip, InsideOfTheRegionLeavesNoTrace) {
  // A many-cornered region around everything but the rim: how it is triangulated must not be seen.
  Line round;
  for (int i = 0; i < 40; ++i)
    round.push_back({2 + 1.9 * std::cos(i * std::numbers::pi / 20), 2 + 1.9 * std::sin(i * std::numbers::pi / 20), 0});
  const Tin in = inside(hill, {{round, {}}});
  for (const Point& p : in.vertices) {
    const bool own = std::find(hill.vertices.begin(), hill.vertices.end(), p) != hill.vertices.end();
    EXPECT_TRUE(own || std::hypot(p.x - 2, p.y - 2) > 1.8);
  }
  EXPECT_EQ(wrong_with_clips(hill, {{round, {}}}), "");
}

TEST(Clip, HolesIslandsAndTouchingCorners) {
  const std::vector<Polygon> nested = {{box(0.5, 0.5, 3.5, 3.5).outer, {box(1, 1, 3, 3).outer}},
                                       {box(1.5, 1.5, 2.5, 2.5).outer, {}}};
  EXPECT_EQ(wrong_with_clips(hill, nested), "");
  EXPECT_EQ(inspect(inside(hill, nested)).components, 2u);
  const std::vector<Polygon> corners = {box(0.5, 0.5, 2, 2), box(2, 2, 3.5, 3.5), box(2.25, 1, 3, 2)};
  EXPECT_EQ(wrong_with_clips(hill, corners), "");
}

TEST(Clip, AreasAddUpExactly) {
  const Tin terrain = support::random_terrain(3000, 4);
  support::Random random(3);
  const std::vector<Polygon> polygons = {
      {support::star({5000, 5000}, 2000, 4500, 23, random), {support::star({5000, 5000}, 500, 1500, 11, random)}}};
  EXPECT_EQ(exact_area(inside(terrain, polygons)) + exact_area(outside(terrain, polygons)), exact_area(terrain));
}

TEST(Clip, BeyondBesideAndAroundTheSurface) {
  EXPECT_TRUE(inside(hill, {box(10, 10, 11, 11)}).faces.empty());
  EXPECT_EQ(outside(hill, {box(10, 10, 11, 11)}), hill);
  EXPECT_TRUE(inside(hill, {box(4, 0, 5, 4)}).faces.empty());  // they share a side
  EXPECT_EQ(outside(hill, {box(4, 0, 5, 4)}), hill);
  EXPECT_EQ(inside(hill, {box(-1, -1, 5, 5)}), hill);
  EXPECT_TRUE(outside(hill, {box(-1, -1, 5, 5)}).faces.empty());
  EXPECT_EQ(inside(hill, {box(0, 0, 4, 4)}), hill);
  for (const auto& b : {box(10, 10, 11, 11), box(4, 0.5, 5, 3), box(-1, -1, 2.5, 5), box(-1, 1.5, 5, 2.5)})
    EXPECT_EQ(wrong_with_clips(hill, {b}), "");
  EXPECT_EQ(inside(hill, {}), Tin{});
  EXPECT_EQ(outside(hill, {}), hill);
}

TEST(Clip, ABorderThatTouchesAnEdgeMakesItsCornerAVertex) {
  const std::vector<Polygon> wedge = {{ring({{1.5, 2}, {1.75, 2.2}, {1.25, 2.2}}), {}}};  // a corner on an edge
  EXPECT_EQ(wrong_with_clips(hill, wedge), "");
}

Tin stepped_surface() {
  Context context;
  const Tin low = support::patch(0, 0, 6, 6, 1), high = support::patch(2, 1.5, 3, 3, 1, 4);
  return merge({high, low}, {Overlap::first, {Seam::wall, 0}}, context).surface.tin;
}

TEST(Clip, WallsAreCutWithTheirFaces) {
  const Tin tin = stepped_surface();
  ASSERT_GT(inspect(tin).walls, 0u);
  const std::vector<std::vector<Polygon>> regions = {{box(1.3, 1.2, 4.1, 3.9)},
                                                     {box(-1, 2.25, 7, 3.75)},
                                                     {{ring({{0.5, 0.5}, {5.7, 1.1}, {2.6, 5.9}}), {}}},
                                                     {box(2.25, 1, 2.75, 2), box(2.75, 1, 3.5, 2)}};
  for (const std::vector<Polygon>& polygons : regions) {
    EXPECT_EQ(wrong_with_clips(tin, polygons), "");
    const Tin in = inside(tin, polygons), out = outside(tin, polygons);
    EXPECT_EQ(support::open_seams(in), "");
    EXPECT_EQ(support::open_seams(out), "");
    EXPECT_EQ(support::open_seams(support::put_together(in, out)), "");
    EXPECT_NEAR(support::wall_area(in) + support::wall_area(out), support::wall_area(tin), 1e-9);
  }
}

TEST(Clip, AWallAlongTheBorderJoinsTheSidesAndBelongsToNeither) {
  const Tin tin = stepped_surface();
  const std::vector<Polygon> top = {box(2, 1.5, 5, 4.5)};
  const Tin in = inside(tin, top), out = outside(tin, top);
  EXPECT_EQ(inspect(in).walls, 0u);
  EXPECT_EQ(inspect(out).walls, 0u);
  Context context;
  EXPECT_EQ(merge({in, out}, {Overlap::first, {Seam::wall, 0}}, context).surface.tin, tin);
}

TEST(Clip, OpenJumpsStayOpen) {
  Context context;
  const Tin low = support::patch(0, 0, 6, 6, 1), high = support::patch(2, 1.5, 3, 3, 1, 4);
  const Tin tin = merge({high, low}, {Overlap::first, {Seam::split, 0}}, context).surface.tin;
  EXPECT_EQ(inspect(tin).walls, 0u);
  EXPECT_EQ(inspect(inside(tin, {box(1.3, 1.2, 4.1, 3.9)})).walls, 0u);
}

TEST(Clip, TheSameBytesForAnyNumberOfThreads) {
  const Tin terrain = support::random_terrain(20000, 5);
  support::Random random(8);
  Context one, four;
  four.threads = 4;
  const PlanRegion region =
      plan_region(std::vector<Polygon>{{support::star({5000, 5000}, 2500, 6000, 300, random), {}}}, one);
  for (const Side side : {Side::inside, Side::outside})
    EXPECT_EQ(clip(terrain, region, side, one).tin, clip(terrain, region, side, four).tin);
}

TEST(Clip, ALargeSurfaceTakesSeconds) {
  const Tin terrain = support::random_terrain(150000, 6);
  support::Random random(9);
  const std::vector<Polygon> polygons = {{support::star({5000, 5000}, 3000, 4900, 5000, random), {}}};
  const std::clock_t begin = std::clock();
  const Tin in = inside(terrain, polygons);
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 20);
  EXPECT_EQ(support::wrong_with(in), "");
}

}  // namespace
}  // namespace terrane
