// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>

#include "core/arithmetic.hpp"
#include "core/merge.hpp"
#include "core/volume.hpp"
#include "support/checks.hpp"
#include "support/terrains.hpp"

// What holds of sums, differences and merges whatever the terrain, for every outside and every seam.
namespace terrane {
namespace {

using support::open_seams;
using support::random_places;
using support::Sampler;
using support::wrong_with;

struct Case {
  const char* name;
  Tin a, b;
};

std::vector<Case> cases() {
  const Tin a = support::random_terrain(400, 1), b = support::random_terrain(350, 2);
  return {{"same square", a, b},
          {"corner", a, support::shifted(b, 3000, -2000)},
          {"holes and islands", support::with_holes(a), support::islands(b)},
          {"rotated L", support::l_shape(a), support::l_shape(support::without_bad_faces(support::rotated(b, 30)))},
          {"grids", support::grid_terrain(12, true), support::shifted(support::grid_terrain(18, false), 2500, 2500)},
          {"grids beside each other", support::grid_terrain(12, true),
           support::shifted(support::grid_terrain(18, false), support::side, 1200, 30)},
          {"steps", support::stepped(300, 4, 1e-3), support::shifted(b, 2000, 1000)},
          {"utm", support::shifted(a, 500000, 4500000), support::shifted(support::with_holes(b), 500500, 4500500)},
          {"patch inside", support::patch(3111, 2777, 30, 20, 97), a}};
}

Assembled combined(const Tin& a, const Tin& b, int sign, Outside outside, Seam seam, int threads = 1) {
  Context context;
  context.threads = threads;
  return combine(a, b, sign, outside, {seam, 0}, context);
}

std::optional<double> expected(double u, double v, int sign, Outside outside) {
  if (!std::isnan(u) && !std::isnan(v)) return u + sign * v;
  if (outside == Outside::drop || (std::isnan(u) && std::isnan(v))) return {};
  return std::isnan(u) ? sign * v : u;
}

std::size_t walls(const Tin& tin) {
  return std::count_if(tin.faces.begin(), tin.faces.end(), [&](const Face& f) { return is_wall(tin, f); });
}

TEST(Seams, OutsideTimesSeamIsRightEverywhere) {
  for (const Case& c : cases())
    for (const auto& [sign, outside] :
         {std::pair(1, Outside::keep), std::pair(1, Outside::drop), std::pair(1, Outside::zero),
          std::pair(-1, Outside::drop), std::pair(-1, Outside::zero)})
      for (const Seam seam : {Seam::wall, Seam::ramp, Seam::split}) {
        SCOPED_TRACE(std::string(c.name) + (sign > 0 ? " +" : " -") + " outside " +
                     std::to_string(static_cast<int>(outside)) + " seam " + std::to_string(static_cast<int>(seam)));
        const Assembled made = combined(c.a, c.b, sign, outside, seam);
        EXPECT_EQ(wrong_with(made.tin), "");
        if (seam != Seam::split) {
          EXPECT_EQ(open_seams(made.tin), "");
        }
        const Sampler za(c.a), zb(c.b), z(made.tin), ramps(made.ramps);
        for (const Point2 p : random_places(bounds(made.tin), 2000, 3)) {
          const auto wanted = expected(za(p), zb(p), sign, outside);
          EXPECT_EQ(wanted.has_value(), !std::isnan(z(p)));
          const bool in_ramp = !made.ramps.faces.empty() && !std::isnan(ramps(p));
          if (in_ramp) {
            EXPECT_TRUE(std::isnan(za(p)) || std::isnan(zb(p))) << "ramps lie outside";
          } else if (wanted) {
            EXPECT_NEAR(z(p), *wanted, 1e-6);
          }
        }
      }
}

TEST(Seams, RampsLeaveNoWallsBesideThoseOfTheInputs) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const Assembled wall = combined(c.a, c.b, 1, Outside::keep, Seam::wall);
    const Assembled ramp = combined(c.a, c.b, 1, Outside::keep, Seam::ramp);
    if (c.name == std::string("holes and islands") || c.name == std::string("rotated L")) {
      EXPECT_LT(walls(ramp.tin), walls(wall.tin) / 4) << "only parts without room keep walls";
    } else if (c.name != std::string("steps")) {
      EXPECT_EQ(walls(ramp.tin), 0u);
    }
    EXPECT_NEAR(plan_area(ramp.tin), plan_area(wall.tin), 1e-11 * plan_area(wall.tin));
    EXPECT_LE(plan_area(ramp.ramps),
              plan_area(wall.tin) - plan_area(combined(c.a, c.b, 1, Outside::drop, Seam::wall).tin) + 1e-3);
  }
}

TEST(Seams, BytesDoNotDependOnOrderOrThreads) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const Tin sum = combined(c.a, c.b, 1, Outside::keep, Seam::ramp).tin;
    EXPECT_EQ(sum, combined(c.b, c.a, 1, Outside::keep, Seam::ramp).tin);
    EXPECT_EQ(sum, combined(c.a, c.b, 1, Outside::keep, Seam::ramp, 4).tin);
    EXPECT_EQ(sum, combined(canonical(support::shuffled(c.a, 3)), canonical(support::shuffled(c.b, 4)), 1,
                            Outside::keep, Seam::ramp)
                       .tin);
    const Tin there = combined(c.a, c.b, -1, Outside::zero, Seam::ramp).tin;
    Tin back = combined(c.b, c.a, -1, Outside::zero, Seam::ramp).tin;
    for (Point& p : back.vertices) p.z = -p.z;
    EXPECT_EQ(plan_area(there), plan_area(back));
    EXPECT_EQ(there.vertices.size(), back.vertices.size());
  }
}

TEST(Seams, NastyPairsAreRamped) {
  for (const std::string& name : support::nasty_pairs())
    for (const bool utm : {false, true}) {
      SCOPED_TRACE(name + (utm ? " utm" : ""));
      const support::Pair pair = support::nasty_pair(name, utm, 200);
      const Assembled sum = combined(pair.a, pair.b, 1, Outside::keep, Seam::ramp);
      EXPECT_EQ(wrong_with(sum.tin), "");
      EXPECT_EQ(open_seams(sum.tin), "");
    }
}

/// Four windows of one terrain that overlap in a cross, each a little different.
std::vector<Tin> windows() {
  std::vector<Tin> tiles;
  for (int i = 0; i < 4; ++i)
    tiles.push_back(support::shifted(support::random_terrain(400, 10 + i), (i % 2) * 8000.0, (i / 2) * 8500.0));
  return tiles;
}

Merged merged(const std::vector<Tin>& tiles, Overlap overlap, Seam seam, int threads = 1) {
  Context context;
  context.threads = threads;
  return merge(tiles, {overlap, {seam, 0}}, context);
}

TEST(Seams, MergesAreRampedUnderEveryPolicy) {
  std::vector<Tin> tiles = windows();
  std::vector<Sampler> samplers;
  for (const Tin& tile : tiles) samplers.emplace_back(tile);
  for (const Overlap policy :
       {Overlap::first, Overlap::last, Overlap::mean, Overlap::median, Overlap::min, Overlap::max, Overlap::sum}) {
    SCOPED_TRACE(static_cast<int>(policy));
    const Merged ramp = merged(tiles, policy, Seam::ramp), wall = merged(tiles, policy, Seam::wall);
    EXPECT_EQ(wrong_with(ramp.surface.tin), "");
    EXPECT_EQ(walls(ramp.surface.tin), 0u);
    EXPECT_EQ(ramp.surface.tin, merged(tiles, policy, Seam::ramp, 4).surface.tin);
    const Sampler z(ramp.surface.tin), before(wall.surface.tin), ramps(ramp.surface.ramps);
    int checked = 0;
    for (const Point2 p : random_places(bounds(ramp.surface.tin), 4000, 6)) {
      if (std::isnan(before(p)) || !std::isnan(ramps(p))) continue;
      ++checked;
      EXPECT_NEAR(z(p), before(p), 1e-6);
    }
    EXPECT_GT(checked, 2000);
    if (policy == Overlap::first || policy == Overlap::last) continue;
    std::vector<Tin> other = {tiles[2], tiles[0], tiles[3], tiles[1]};
    EXPECT_EQ(ramp.surface.tin, merged(other, policy, Seam::ramp).surface.tin);
  }
}

TEST(Seams, AMergeOfTheCutsIsTheOriginalWithRamps) {
  const Tin whole = support::random_terrain(500, 8);
  std::vector<Tin> cuts;
  for (int i = 0; i < 4; ++i)
    cuts.push_back(support::without(whole, [i](Point2 c) { return (c.x > 4000) + 2 * (c.y > 6000) != i; }));
  for (const Overlap policy :
       {Overlap::first, Overlap::last, Overlap::mean, Overlap::median, Overlap::min, Overlap::max, Overlap::sum}) {
    const Merged result = merged(cuts, policy, Seam::ramp);
    EXPECT_EQ(result.surface.tin, whole);
    EXPECT_TRUE(result.surface.ramps.faces.empty());
  }
}

TEST(Seams, TilesThatShareABorderMeetThere) {
  const Tin west = support::patch(0, 0, 6, 6, 1), east = support::patch(6, 0, 9, 9, 2.0 / 3, 50);
  for (const Overlap policy :
       {Overlap::first, Overlap::last, Overlap::mean, Overlap::median, Overlap::min, Overlap::max, Overlap::sum}) {
    const Tin tin = merged({west, east}, policy, Seam::ramp).surface.tin;
    EXPECT_EQ(wrong_with(tin), "");
    EXPECT_EQ(walls(tin), 0u);
  }
}

Merged blended(const std::vector<Tin>& tiles, double width, BlendSide side, double tolerance, int threads = 1,
               Seam seam = Seam::wall) {
  Context context;
  context.threads = threads;
  MergeOptions options{Overlap::blend, {seam, 0}};
  options.blend = {width, side, tolerance, {1, 1}};
  return merge(tiles, options, context);
}

/// The highest wall further than `apart` from every place in `except`.
double highest_wall(const Tin& tin, const std::vector<Point2>& except, double apart) {
  double highest = 0;
  for (const Face& f : tin.faces) {
    if (!is_wall(tin, f)) continue;
    bool excepted = false;
    for (const Point2 e : except)
      for (const Index v : f)
        excepted = excepted || std::hypot(tin.vertices[v].x - e.x, tin.vertices[v].y - e.y) <= apart;
    if (excepted) continue;
    const auto [low, high] = std::minmax({tin.vertices[f[0]].z, tin.vertices[f[1]].z, tin.vertices[f[2]].z});
    highest = std::max(highest, high - low);
  }
  return highest;
}

/// Where borders of tiles cross.
std::vector<Point2> border_crossings(const std::vector<Tin>& tiles) {
  std::vector<Point2> places;
  for (std::size_t i = 0; i < tiles.size(); ++i)
    for (std::size_t j = 0; j < tiles.size(); ++j) {
      const Box a = bounds(tiles[i]), b = bounds(tiles[j]);
      for (const double x : {a.xmin, a.xmax})
        for (const double y : {b.ymin, b.ymax}) places.push_back({x, y});
    }
  return places;
}

TEST(Blends, NothingJumpsWhereSurveysMeet) {
  const std::vector<Tin> tiles = windows();
  for (const BlendSide side : {BlendSide::both, BlendSide::inside, BlendSide::outside}) {
    SCOPED_TRACE(static_cast<int>(side));
    const Merged made = blended(tiles, 900, side, 5);
    EXPECT_EQ(wrong_with(made.surface.tin), "");
    EXPECT_EQ(open_seams(made.surface.tin), "");
    EXPECT_LE(made.blend.bound, 5);
    const double apart = side == BlendSide::both ? 1.01 * made.blend.radius : -1;
    EXPECT_LT(highest_wall(made.surface.tin, border_crossings(tiles), apart), 1e-6);
    EXPECT_EQ(made.surface.tin, blended(tiles, 900, side, 5, 4).surface.tin);
    EXPECT_NEAR(plan_area(made.surface.tin), plan_area(merged(tiles, Overlap::first, Seam::wall).surface.tin), 1e-2);
  }
}

TEST(Blends, BothLeaveTheLoneSurfacesAndStayBetween) {
  const std::vector<Tin> tiles = windows();
  const Tin tin = blended(tiles, 900, BlendSide::both, 5).surface.tin;
  std::vector<Sampler> samplers;
  for (const Tin& tile : tiles) samplers.emplace_back(tile);
  const Sampler z(tin);
  for (const Point2 p : random_places(bounds(tin), 4000, 6)) {
    double low = INFINITY, high = -INFINITY;
    for (const Sampler& s : samplers)
      if (const double h = s(p); !std::isnan(h)) low = std::min(low, h), high = std::max(high, h);
    EXPECT_EQ(std::isinf(low), std::isnan(z(p)));
    if (std::isinf(low)) continue;
    EXPECT_GT(z(p), low - 5 - 1e-6);
    EXPECT_LT(z(p), high + 5 + 1e-6);
    if (low == high) {
      EXPECT_NEAR(z(p), low, 1e-6);
    }
  }
}

TEST(Blends, OutsideKeepsTheFirstTileUntouchedAndReachesNoFurtherThanTheWidth) {
  const Tin survey = support::patch(3111, 2777, 30, 20, 97, 40), dem = support::random_terrain(400, 1);
  const Box box = bounds(survey);
  const Merged made = blended({survey, dem}, 700, BlendSide::outside, 1);
  EXPECT_EQ(wrong_with(made.surface.tin), "");
  EXPECT_EQ(walls(made.surface.tin), 0u);
  EXPECT_LE(made.blend.bound, 1);
  const Sampler z(made.surface.tin), of_survey(survey), of_dem(dem), bent(made.surface.ramps);
  int beside = 0;
  for (const Point2 p : random_places(bounds(dem), 8000, 5)) {
    const double dx = std::max({box.xmin - p.x, 0.0, p.x - box.xmax}),
                 dy = std::max({box.ymin - p.y, 0.0, p.y - box.ymax});
    if (!std::isnan(of_survey(p))) {
      EXPECT_NEAR(z(p), of_survey(p), 1e-6);
    } else if (std::hypot(dx, dy) >= 700) {
      EXPECT_NEAR(z(p), of_dem(p), 1);
    } else {
      ++beside;
    }
    if (!std::isnan(bent(p))) {
      EXPECT_LT(std::hypot(dx, dy), 1500);
    }
  }
  EXPECT_GT(beside, 500);
}

TEST(Blends, InsideBendsTheFirstTileOnly) {
  const Tin survey = support::patch(3111, 2777, 30, 20, 97, 40), dem = support::random_terrain(400, 1);
  const Box box = bounds(survey);
  const Merged made = blended({survey, dem}, 300, BlendSide::inside, 1);
  EXPECT_EQ(wrong_with(made.surface.tin), "");
  EXPECT_EQ(walls(made.surface.tin), 0u);
  const Sampler z(made.surface.tin), of_survey(survey), of_dem(dem);
  for (const Point2 p : random_places(bounds(dem), 8000, 5)) {
    const double depth = std::min({p.x - box.xmin, box.xmax - p.x, p.y - box.ymin, box.ymax - p.y});
    if (depth <= 0) {
      EXPECT_NEAR(z(p), of_dem(p), 1e-6);
    } else if (depth >= 300) {
      EXPECT_NEAR(z(p), of_survey(p), 1);
    }
  }
}

TEST(Blends, TilesThatShareABorderAreBentToIt) {
  const Tin west = support::patch(0, 0, 20, 20, 10), east = support::patch(200, 0, 25, 25, 8, 12);
  for (const BlendSide side : {BlendSide::inside, BlendSide::outside}) {
    const Merged made = blended({west, east}, 50, side, 0.01);
    EXPECT_EQ(wrong_with(made.surface.tin), "");
    EXPECT_EQ(walls(made.surface.tin), 0u);
    const Sampler z(made.surface.tin), stays(side == BlendSide::outside ? west : east);
    for (const Point2 p :
         random_places(side == BlendSide::outside ? Box{0, 0, 200, 200} : Box{200, 0, 400, 200}, 500, 2))
      EXPECT_NEAR(z(p), stays(p), 1e-9);
  }
}

TEST(Blends, RandomDomainsGiveSoundSurfaces) {
  for (const Case& c : cases())
    for (const BlendSide side : {BlendSide::both, BlendSide::inside, BlendSide::outside})
      for (const Seam seam : {Seam::wall, Seam::ramp}) {
        SCOPED_TRACE(std::string(c.name) + " " + std::to_string(static_cast<int>(side)));
        const Merged made = blended({c.a, c.b}, 800, side, 5, 1, seam);
        EXPECT_EQ(wrong_with(made.surface.tin), "");
        EXPECT_EQ(open_seams(made.surface.tin), "");
        EXPECT_LE(made.blend.bound, 5);
        EXPECT_EQ(
            made.surface.tin,
            blended({canonical(support::shuffled(c.a, 3)), canonical(support::shuffled(c.b, 4))}, 800, side, 5, 2, seam)
                .surface.tin);
      }
}

TEST(Seams, LargeSurfacesAreRampedInSeconds) {
  const Tin a = support::random_terrain(125000, 1),
            b = support::shifted(support::random_terrain(125000, 2), 3000, 2000);
  ASSERT_GE(a.faces.size() + b.faces.size(), 490000u);
  const std::clock_t start = std::clock();  // the processor's time: others may be at work
  const Tin sum = combined(a, b, 1, Outside::keep, Seam::ramp, 2).tin;
  EXPECT_LT((std::clock() - start) / CLOCKS_PER_SEC, 30);
  EXPECT_EQ(walls(sum), 0u);
}

TEST(Blends, LargeSurfacesAreBlendedInSeconds) {
  const Tin a = support::random_terrain(125000, 1),
            b = support::shifted(support::random_terrain(125000, 2), 3000, 2000);
  for (const BlendSide side : {BlendSide::both, BlendSide::outside}) {
    const std::clock_t start = std::clock();  // the processor's time: others may be at work
    const Merged made = blended({a, b}, 300, side, 1, 2);
    EXPECT_LT((std::clock() - start) / CLOCKS_PER_SEC, 30);
    EXPECT_LE(made.blend.bound, 1);
  }
}

}  // namespace
}  // namespace terrane
