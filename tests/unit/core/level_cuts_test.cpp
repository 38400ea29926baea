// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/level_cuts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "core/arithmetic.hpp"
#include "core/error.hpp"
#include "core/validate.hpp"
#include "core/volume.hpp"
#include "support/checks.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::drawn;
using support::open_seams;
using support::wrong_with;

LevelZones zones(const Tin& tin, std::vector<double> levels) {
  Context context;
  return level_zones(tin, levels, context);
}

/// Zone i at height i.
Tin terraces(const Tin& tin, const std::vector<double>& levels) {
  Context context;
  std::vector<double> heights(levels.size() + 1);
  std::iota(heights.begin(), heights.end(), 0.0);
  return lifted(level_zones(tin, levels, context).mesh, heights, context).tin;
}

std::vector<double> areas(const Tin& tin, const std::vector<double>& levels) {
  std::vector<double> sum(levels.size() + 1, 0);
  const ZonedMesh mesh = zones(tin, levels).mesh;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Point2 p = mesh.points[mesh.faces[f][0]], q = mesh.points[mesh.faces[f][1]],
                 r = mesh.points[mesh.faces[f][2]];
    sum[mesh.zone[f]] += 0.5 * ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x));
  }
  return sum;
}

Index zone_of(double z, const std::vector<double>& levels) {
  return static_cast<Index>(std::upper_bound(levels.begin(), levels.end(), z) - levels.begin());
}

/// Validity, the heights at random places, and the areas against the integrals of core/volume.
void judge(const Tin& tin, const std::vector<double>& levels, int places = 2000) {
  const Tin result = terraces(tin, levels);
  EXPECT_EQ(wrong_with(result), "");
  EXPECT_EQ(open_seams(result), "");
  const double whole = plan_area(tin);
  EXPECT_NEAR(plan_area(result), whole, 1e-9 * whole);
  const support::Sampler before(tin), after(result);
  const double largest = std::max(1.0, std::fabs(levels.back()));
  for (const Point2 at : support::random_places(bounds(tin), places, 3)) {
    const double z = before(at);
    if (std::isnan(z) || !before.clear_of_edges(at, 1e-6) || !after.clear_of_edges(at, 1e-6)) continue;
    const auto near = std::lower_bound(levels.begin(), levels.end(), z - 1e-9 * largest);
    if (near != levels.end() && std::fabs(*near - z) <= 1e-9 * largest) continue;
    ASSERT_NEAR(after(at), zone_of(z, levels), 1e-9) << at.x << " " << at.y << " at " << z;
  }
  const std::vector<double> by_zone = areas(tin, levels);
  Context context;
  double above = 0;
  for (std::size_t i = levels.size(); i-- > 0;) {
    above += by_zone[i + 1];
    const Volume v = volume(tin, levels[i], 0, {}, context);
    EXPECT_NEAR(above, v.fill.area_2d + v.same_area_2d, 1e-8 * whole) << levels[i];
  }
}

TEST(LevelZones, AreWhereTheSurfaceIs) {
  judge(support::random_terrain(3000, 1), {20});
  judge(support::random_terrain(3000, 2), {-50, -10, 0, 1, 2, 40, 200});
  judge(support::shifted(support::random_terrain(3000, 3), 500000, 4500000), {-5, 0.1, 5});
  judge(support::with_holes(support::random_terrain(2000, 4)), {-20, 0, 20});
  judge(support::islands(support::random_terrain(2000, 5)), {-20, 0, 20});
}

TEST(LevelZones, TheAreaOfALevelHasItsTies) {
  // A mesa whose top is at 2; its rim is at 1.
  const Tin mesa = drawn(
      "11111\n"
      "12221\n"
      "12221\n"
      "12221\n"
      "11111");
  EXPECT_EQ(areas(mesa, {2}), (std::vector<double>{12, 4}));
  EXPECT_EQ(areas(mesa, {1}), (std::vector<double>{0, 16}));
  EXPECT_EQ(plan_area(flat_faces(mesa, std::vector<double>{2})), 4);
  EXPECT_EQ(flat_faces(mesa, std::vector<double>{1.5}).faces.size(), 0u);
}

TEST(LevelZones, WhereTheSurfaceOnlyReachesALevelThereIsNoArea) {
  const Tin peak = drawn(
      "000\n"
      "010\n"
      "000");
  const Tin pit = drawn(
      "111\n"
      "101\n"
      "111");
  const Tin ridge = drawn(
      "00000\n"
      "01110\n"
      "00000");
  EXPECT_EQ(areas(peak, {1}), (std::vector<double>{4, 0}));
  EXPECT_EQ(areas(pit, {0}), (std::vector<double>{0, 4}));
  EXPECT_EQ(areas(ridge, {1}), (std::vector<double>{8, 0}));
  EXPECT_EQ(terraces(peak, {1}).faces.size(), 2u) << "only the corners are needed";
}

TEST(LevelZones, NeedNoPointsInside) {
  const Tin result = terraces(support::grid_terrain(60, true), {1e9});
  EXPECT_EQ(result.vertices.size(), 4u);
  EXPECT_EQ(result.faces.size(), 2u);
}

TEST(LevelZones, AStraightContourNeedsItsEndsAlone) {
  Tin plane = support::random_terrain(2000, 8);
  for (Point& p : plane.vertices) p.z = 0.3 * p.x + 0.1 * p.y;
  const ZonedMesh mesh = zones(canonical(plane), {1234.5}).mesh;
  EXPECT_EQ(mesh.points.size(), 6u);
  EXPECT_EQ(mesh.faces.size(), 4u);
}

TEST(LevelZones, AreDividedOnEitherSideOfAJump) {
  // Two slopes that meet in a jump along the inner square's border, which changes sign.
  Tin slope = support::patch(0, 0, 8, 8, 10), other = support::patch(20, 20, 4, 4, 10, 0);
  for (Point& p : slope.vertices) p.z = 0.37 * p.x;
  for (Point& p : other.vertices) p.z = 0.53 * p.y - 4;
  Context context;
  const Tin both = combine(canonical(slope), canonical(other), 1, Outside::keep, {Seam::wall, 0}, context).tin;
  ASSERT_GT(inspect(both).walls, 0u);
  judge(both, {3, 7.5, 12, 13, 14, 20, 30});
  std::vector<double> many;
  for (int i = 0; i < 400; ++i) many.push_back(0.1 * i + 0.05);
  judge(both, many);
}

TEST(LevelZones, OneFaceMayCrossThousandsOfLevels) {
  const Tin face = canonical(Tin{{{0, 0, 0}, {100, 0, 50}, {0, 100, 100}}, {{0, 1, 2}}});
  std::vector<double> levels;
  for (int i = 1; i < 5000; ++i) levels.push_back(0.02 * i);
  const Tin result = terraces(face, levels);
  EXPECT_EQ(wrong_with(result), "");
  EXPECT_EQ(open_seams(result), "");
  EXPECT_NEAR(plan_area(result), 5000, 1e-8);
}

TEST(LevelZones, SteepFacesAndLevelsAtTheirCornersStayValid) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Tin tin = support::shifted(support::stepped(300, seed, seed % 3 == 0 ? 1e-7 : 0.01), 500000, 4500000);
    std::mt19937_64 random(seed);
    std::vector<double> levels;
    for (int i = 0; i < 6; ++i) {
      double z = tin.vertices[random() % tin.vertices.size()].z;
      if (i % 3 == 1) z = std::nextafter(z, 1e9);
      if (i % 3 == 2) z += 1e-8;
      levels.push_back(z);
    }
    std::sort(levels.begin(), levels.end());
    std::vector<double> apart;
    for (const double z : levels)
      if (apart.empty() || z - apart.back() > 1e-5) apart.push_back(z);
    const Tin result = terraces(canonical(tin), apart);
    EXPECT_EQ(wrong_with(result), "") << seed;
    EXPECT_EQ(open_seams(result), "") << seed;
    EXPECT_NEAR(plan_area(result), plan_area(tin), 1e-9 * plan_area(tin)) << seed;
  }
}

TEST(LevelZones, TilesCutASharedEdgeAtTheSamePlaces) {
  const Tin whole = support::random_terrain(1000, 12);
  const Tin left = support::without(whole, [](Point2 c) { return c.x > 5000; }),
            right = support::without(whole, [](Point2 c) { return c.x <= 5000; });
  Context context;
  const std::vector<double> levels = {0.0};
  const Tin a = terraces(left, levels), b = terraces(right, levels);
  // Vertices of one that lie on the other's border are vertices of it where the zone changes.
  std::size_t shared = 0;
  for (const Point& p : a.vertices) shared += std::find(b.vertices.begin(), b.vertices.end(), p) != b.vertices.end();
  EXPECT_GT(shared, 20u);
}

TEST(LevelZones, DoNotDependOnTheOrderOfFaces) {
  const Tin tin = support::random_terrain(1500, 6);
  EXPECT_EQ(terraces(tin, {0, 5, 10}), terraces(canonical(support::shuffled(tin, 9)), {0, 5, 10}));
}

TEST(LevelZones, RefuseLevelsThatCannotBeToldApart) {
  const Tin tin = support::random_terrain(100, 6);
  EXPECT_THROW(zones(tin, {1, std::nextafter(1.0, 2.0)}), Error);
  EXPECT_NO_THROW(zones(tin, {1e6, std::nextafter(1e6, 2e6)})) << "where the surface does not reach them they may be";
}

TEST(LevelZones, OfALargeSurfaceTakeSeconds) {
  const Tin tin = support::random_terrain(150000, 7);
  const Tin result = terraces(tin, {-40, -20, 0, 20, 40});
  const Inspection seen = inspect(result);
  EXPECT_EQ(seen.inverted + seen.degenerate + seen.t_junctions + seen.non_manifold_edges + seen.overlaps, 0u);
  EXPECT_NEAR(plan_area(result), plan_area(tin), 1e-9 * plan_area(tin));
}

}  // namespace
}  // namespace terrane
