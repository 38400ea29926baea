// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/simplify.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <set>
#include <tuple>

#include "core/arithmetic.hpp"
#include "core/error.hpp"
#include "core/merge.hpp"
#include "core/simplify/deviation.hpp"
#include "core/validate.hpp"
#include "core/volume.hpp"
#include "support/checks.hpp"
#include "support/small_mesh.hpp"
#include "support/surface_distance.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::drawn;
using support::surface_distance;
using support::wrong_with;

Simplified simplified(const Tin& tin, SimplifyOptions options, int threads = 1) {
  Context context;
  context.threads = threads;
  return simplify(tin, options, context);
}

Simplified without_flat_vertices(const Tin& tin, bool keep_boundary = true) {
  return simplified(tin, {coplanar_tolerance(tin), 0, keep_boundary});
}

/// Sound, on vertices of the surface, over the same domain, within the bound that an exact overlay measures.
void expect_right(const Tin& tin, const Simplified& made, double bound) {
  EXPECT_EQ(wrong_with(made.tin), "");
  EXPECT_EQ(support::missing_vertices(made.tin, tin), 0u);
  const auto measured = surface_distance(tin, made.tin);
  EXPECT_LE(measured.largest, bound * (1 + 1e-12) + 1e-11);
  EXPECT_NEAR(measured.largest, made.error, 1e-9 + 1e-9 * made.error);
  EXPECT_NEAR(measured.shared, plan_area(tin), 1e-9 * plan_area(tin));
  EXPECT_NEAR(plan_area(made.tin), plan_area(tin), 1e-9 * plan_area(tin));
}

using Border = std::set<std::tuple<double, double, double, double, double, double>>;
Border border_of(const Tin& tin) {
  Border border;
  for (const Face& f : tin.faces)
    for (int k = 0; k < 3; ++k) {
      const Point &p = tin.vertices[f[k]], &q = tin.vertices[f[(k + 1) % 3]];
      if (border.erase({q.x, q.y, q.z, p.x, p.y, p.z}) == 0) border.insert({p.x, p.y, p.z, q.x, q.y, q.z});
    }
  return border;
}

TEST(Simplify, StaysWithinTheBoundOnRandomTerrain) {
  for (const double bound : {0.0, 2.0, 20.0, 200.0}) {
    const Tin tin = support::random_terrain(300, 9);
    const Simplified made = simplified(tin, {bound});
    expect_right(tin, made, bound);
    EXPECT_EQ(border_of(made.tin), border_of(tin));
    if (bound > 100) {
      EXPECT_LT(made.tin.faces.size(), tin.faces.size() / 4);
    }
  }
}

TEST(Simplify, StaysWithinTheBoundOnSmallMeshesOfAllKinds) {
  support::Random random(4);
  int removed = 0;
  for (int round = 0; round < 400; ++round) {
    std::vector<Point> points;
    const int n = 5 + support::below(random, 25);
    const bool lattice = round % 2 == 0;
    for (int i = 0; i < n; ++i) {
      const double x = support::uniform(random, 0, 8), y = support::uniform(random, 0, 8);
      const double z = round % 3 == 0 ? support::below(random, 2) : support::uniform(random, 0, 1);
      points.push_back(lattice ? Point{std::floor(x), std::floor(y), z} : Point{x, y, z});
    }
    Tin tin = support::swept(points);
    if (tin.faces.empty()) continue;
    tin = canonical(support::flipped(std::move(tin), 10, random));
    const double bound = support::uniform(random, 0, 1);
    const bool keep = round % 4 < 2;
    const Simplified made = simplified(tin, {bound, 0, keep});
    expect_right(tin, made, bound);
    if (keep) {
      EXPECT_EQ(border_of(made.tin), border_of(tin));
    }
    removed += static_cast<int>(tin.vertices.size() - made.tin.vertices.size());
    if (testing::Test::HasFailure()) FAIL() << "round " << round;
  }
  EXPECT_GT(removed, 1000);
}

TEST(Simplify, HolesIslandsAndNotchesKeepTheirShape) {
  const Tin tin = support::random_terrain(600, 5);
  for (const Tin& part : {support::with_holes(tin), support::islands(tin), support::l_shape(tin)}) {
    const Simplified made = simplified(part, {30});
    expect_right(part, made, 30);
    EXPECT_EQ(border_of(made.tin), border_of(part));
    EXPECT_EQ(inspect(made.tin).holes, inspect(part).holes);
    EXPECT_EQ(inspect(made.tin).components, inspect(part).components);
  }
}

TEST(Simplify, CoplanarFacesBecomeFew) {
  // A roof: two planes on either side of a ridge in the middle, 9 x 9 samples.
  Tin roof = drawn("012343210\n012343210\n012343210\n012343210\n012343210\n012343210\n012343210\n012343210\n012343210");
  const Simplified kept = without_flat_vertices(roof);
  expect_right(roof, kept, 0);
  EXPECT_EQ(kept.tin.vertices.size(), 32u) << "the border alone";
  const Simplified freed = without_flat_vertices(roof, false);
  expect_right(roof, freed, 0);
  EXPECT_EQ(freed.tin.vertices.size(), 6u);
  EXPECT_EQ(freed.tin.faces.size(), 4u);
}

TEST(Simplify, ADifferenceWithItselfBecomesItsBorder) {
  const Tin tin = support::random_terrain(500, 3);
  Context context;
  const Tin flat = combine(tin, tin, -1, Outside::drop, {}, context).tin;
  const Simplified made = without_flat_vertices(flat);
  EXPECT_EQ(made.tin.vertices.size(), border_of(flat).size());
  EXPECT_EQ(made.tin.faces.size(), border_of(flat).size() - 2);
  EXPECT_EQ(wrong_with(made.tin), "");
  const Simplified freed = without_flat_vertices(flat, false);
  EXPECT_EQ(freed.tin.faces.size(), 2u) << "the sides of the square are straight";
}

TEST(Simplify, WhatAnOverlayAddedGoesAgain) {
  for (const Point2 origin : {Point2{0, 0}, Point2{500000, 4500000}}) {
    const Tin a = canonical(support::shifted(support::random_terrain(200, 1), origin.x, origin.y));
    const Tin b = canonical(support::shifted(support::random_terrain(200, 2), origin.x, origin.y));
    Context context;
    const Tin sum = combine(a, b, 1, Outside::drop, {}, context).tin;
    const Tin again = combine(sum, b, -1, Outside::drop, {}, context).tin;
    const Simplified made = without_flat_vertices(again);
    expect_right(again, made, coplanar_tolerance(again));
    EXPECT_GT(again.faces.size(), 3 * a.faces.size());
    // The borders of both stay, with all that either has there.
    EXPECT_LT(made.tin.faces.size(), a.faces.size() + border_of(again).size() + a.faces.size() / 50);
    EXPECT_LT(surface_distance(a, made.tin).largest, 2 * coplanar_tolerance(again));
  }
}

TEST(Simplify, WallsAndJumpsStay) {
  const Tin low = support::patch(0, 0, 12, 12, 1), high = support::patch(3.5, 3.5, 5, 5, 1, 40);
  for (const Seam seam : {Seam::wall, Seam::split}) {
    Context context;
    const Tin both = merge({high, low}, {Overlap::first, {seam, 0}}, context).surface.tin;
    for (const bool keep : {true, false}) {
      const Simplified made = simplified(both, {15, 0, keep});
      EXPECT_EQ(wrong_with(made.tin), "");
      EXPECT_LT(made.tin.faces.size(), both.faces.size());
      EXPECT_LE(surface_distance(both, made.tin).largest, 15 + 1e-9);
      EXPECT_EQ(inspect(made.tin).walls, inspect(both).walls);
      if (seam == Seam::wall) {
        EXPECT_EQ(support::open_seams(made.tin), "");
      }
      EXPECT_NEAR(plan_area(made.tin), plan_area(both), 1e-9 * plan_area(both));
    }
  }
}

TEST(Simplify, SeamsWhoseJumpsBeginAndEndAtVertices) {
  support::Random random(6);
  for (int round = 0; round < 40; ++round) {
    std::vector<Tin> tiles;
    for (int i = 0; i < 2; ++i) {
      std::string picture;
      for (int y = 0; y < 6; ++y, picture += '\n')
        for (int x = 0; x < 6; ++x) picture += '0' + support::below(random, 3);
      tiles.push_back(canonical(drawn(picture, 1, {0.5 * support::below(random, 9), 0.5 * support::below(random, 9)})));
    }
    Context context;
    const Tin both = merge(tiles, {Overlap::first, {round % 2 ? Seam::wall : Seam::split, 0}}, context).surface.tin;
    const Simplified made = simplified(both, {1, 0, round % 4 < 2});
    expect_right(both, made, 1);
    EXPECT_EQ(inspect(made.tin).walls, inspect(both).walls);
  }
}

TEST(Simplify, TilesSimplifiedApartStillMeet) {
  const Tin whole = canonical(support::grid_terrain(24, true));
  const auto west = [](Point2 c) { return c.x < support::side / 2; };
  const Tin left = support::without(whole, [&](Point2 c) { return !west(c); }), right = support::without(whole, west);
  const Tin a = simplified(left, {40}).tin, b = simplified(right, {40}).tin;
  EXPECT_LT(a.faces.size(), left.faces.size() / 2);
  Context context;
  const Tin again = merge({a, b}, {}, context).surface.tin;
  EXPECT_EQ(again.faces.size(), a.faces.size() + b.faces.size()) << "vertex on vertex, no face was cut";
  EXPECT_EQ(inspect(again).walls, 0u);
  EXPECT_EQ(wrong_with(again), "");
  EXPECT_LE(surface_distance(whole, again).largest, 40 + 1e-9);
}

TEST(Simplify, StopsAtTheNumberOfFacesAndSaysHowFarItIs) {
  const Tin tin = support::random_terrain(500, 8);
  const Simplified made = simplified(tin, {INFINITY, 300});
  EXPECT_LE(made.tin.faces.size(), 300u);
  EXPECT_GE(made.tin.faces.size(), 299u);
  expect_right(tin, made, INFINITY);
  EXPECT_GT(made.error, 0);
  const Simplified bound_first = simplified(tin, {1, 300});
  EXPECT_GT(bound_first.tin.faces.size(), 300u);
  expect_right(tin, bound_first, 1);
  const std::size_t border = border_of(tin).size();
  const Simplified least = simplified(tin, {INFINITY, 2});
  EXPECT_EQ(least.tin.faces.size(), border - 2) << "the border alone is left";
}

TEST(Simplify, AHighFanIsTakenApart) {
  Tin disc{{{0, 0, 0}}, {}};
  constexpr int spokes = 300;
  for (int i = 0; i < spokes; ++i)
    disc.vertices.push_back({std::cos(2 * M_PI * i / spokes), std::sin(2 * M_PI * i / spokes), 0});
  for (int i = 0; i < spokes; ++i) disc.faces.push_back({0, 1 + i, 1 + (i + 1) % spokes});
  disc = canonical(disc);
  const Simplified made = without_flat_vertices(disc);
  EXPECT_EQ(made.tin.faces.size(), static_cast<std::size_t>(spokes - 2));
  EXPECT_EQ(wrong_with(made.tin), "");
}

TEST(Simplify, NothingToTakeOut) {
  EXPECT_EQ(simplified({}, {1}).tin, Tin{});
  const Tin one = canonical(Tin{{{0, 0, 0}, {1, 0, 0}, {0, 1, 5}}, {{0, 1, 2}}});
  for (const bool keep : {true, false}) EXPECT_EQ(simplified(one, {1, 0, keep}).tin, one);
  EXPECT_EQ(simplified(one, {INFINITY, 1}).tin, one);
}

TEST(Simplify, TheSameBytesForAnyThreadsAndOrder) {
  const Tin tin = support::random_terrain(6000, 12);
  const Tin once = simplified(tin, {15}).tin;
  EXPECT_EQ(simplified(tin, {15}, 2).tin, once);
  EXPECT_EQ(simplified(canonical(support::shuffled(tin, 3)), {15}).tin, once);
  EXPECT_EQ(simplified(tin, {INFINITY, 3000}, 2).tin, simplified(tin, {INFINITY, 3000}).tin);
}

TEST(Simplify, AQuarterOfAMillionFacesTakeSeconds) {
  const Tin tin = support::random_terrain(125000, 6);
  const std::clock_t begin = std::clock();
  const Simplified made = simplified(tin, {10});
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 15);
  EXPECT_LT(made.tin.faces.size(), tin.faces.size() / 20);
  Context context;
  EXPECT_LE(largest_difference(tin, made.tin, context), 10 + 1e-6);
  EXPECT_EQ(wrong_with(made.tin), "");
}

TEST(Simplify, CanBeStopped) {
  const Tin tin = support::random_terrain(20000, 6);
  Context context;
  context.cancelled = true;
  EXPECT_THROW(simplify(tin, {10}, context), Error);
}

}  // namespace
}  // namespace terrane
