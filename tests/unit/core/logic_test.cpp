// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/logic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/error.hpp"
#include "core/level_cuts.hpp"
#include "core/validate.hpp"
#include "core/volume.hpp"
#include "support/checks.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::drawn;
using support::open_seams;
using support::wrong_with;

constexpr TruthTable and_table = {is_false, is_false, is_false, is_true},
                     or_table = {is_false, is_true, is_true, is_true},
                     xor_table = {is_false, is_true, is_true, is_false},
                     nand_table = {is_true, is_true, is_true, is_false},
                     nor_table = {is_true, is_false, is_false, is_false};
const std::vector<double> levels = {0, 255};

Binary read(const Tin& tin, double mean = 127.5) {
  Context context;
  return read_binary(tin, {mean, {}, "input"}, context);
}

Tin surface(const ZonedMesh& mesh) {
  Context context;
  return lifted(mesh, levels, context).tin;
}

/// True where the drawn terrain is at least 1.
Tin binary(std::string_view picture, Point2 lower_left = {0, 0}) {
  Context context;
  return surface(level_zones(drawn(picture, 1, lower_left), std::vector<double>{1}, context).mesh);
}

/// True in these rectangles, false in the rest of a square of that side.
Tin blocks(double side, const std::vector<Box>& boxes) {
  Context context;
  ZonedMesh mesh{{{0, 0}, {side, 0}, {side, side}, {0, side}}, {{0, 1, 2}, {0, 2, 3}}, {0, 0}, {}};
  RoundingReport rounding;
  for (const Box& b : boxes) {
    const ZonedMesh block{
        {{b.xmin, b.ymin}, {b.xmax, b.ymin}, {b.xmax, b.ymax}, {b.xmin, b.ymax}}, {{0, 1, 2}, {0, 2, 3}}, {1, 1}, {}};
    mesh = fold_zones(
        mesh, block, [](Index x, Index y) { return y == none ? x : y; }, rounding, context);
  }
  return surface(mesh);
}

Combined combined(const Tin& a, const Tin& b, const TruthTable& table, Extent extent = Extent::overlap) {
  Context context;
  return combine(read(a).mesh, read(b).mesh, table, extent, context);
}

double true_area(const ZonedMesh& mesh) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Point2 p = mesh.points[mesh.faces[f][0]], q = mesh.points[mesh.faces[f][1]],
                 r = mesh.points[mesh.faces[f][2]];
    if (mesh.zone[f] == is_true) sum += 0.5 * ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x));
  }
  return sum;
}

Tin negated(Tin tin) {
  for (Point& p : tin.vertices) p.z = 255 - p.z;
  return canonical(std::move(tin));
}

/// Without walls, which are triangulated from the bottom up.
Tin level_parts(Tin tin) {
  std::erase_if(tin.faces, [&](const Face& f) { return is_wall(tin, f); });
  return canonical(std::move(tin));
}

Tin operated(const Tin& a, const Tin& b, const TruthTable& table, Extent extent = Extent::overlap) {
  const Tin result = surface(combined(a, b, table, extent).mesh);
  EXPECT_EQ(wrong_with(result), "");
  EXPECT_EQ(open_seams(result), "");
  return result;
}

TEST(ReadBinary, FindsTheLevelsAndTheirAreas) {
  const Binary b = read(blocks(10, {{1, 1, 4, 4}, {4, 4, 6, 7}}));
  EXPECT_EQ(b.lower, 0);
  EXPECT_EQ(b.upper, 255);
  EXPECT_DOUBLE_EQ(true_area(b.mesh), 9 + 6);
}

TEST(ReadBinary, OneLevelAloneIsComparedWithTheMean) {
  Tin flat = drawn("00\n00");
  const auto at = [&](double z) {
    for (Point& p : flat.vertices) p.z = z;
    return true_area(read(flat).mesh);
  };
  EXPECT_EQ(at(0), 0);
  EXPECT_EQ(at(127.5), 1) << "the mean itself is true, as levels are";
  EXPECT_EQ(at(255), 1);
}

TEST(ReadBinary, LevelsMayBeOffByRounding) {
  Tin tin = blocks(10, {{1, 1, 4, 4}});
  for (std::size_t v = 0; v < tin.vertices.size(); v += 2) tin.vertices[v].z += 5e-10;
  EXPECT_DOUBLE_EQ(true_area(read(canonical(tin)).mesh), 9);
}

TEST(ReadBinary, SteepFacesVanishIntoBothSides) {
  // A wall that leans: 255 up over 0.01 in plan.
  Tin tin{{{0, 0, 0}, {5, 0, 0}, {5.01, 0, 255}, {10, 0, 255}, {0, 10, 0}, {5, 10, 0}, {5.01, 10, 255}, {10, 10, 255}},
          {{0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}}};
  tin = canonical(tin);
  const Binary b = read(tin);
  EXPECT_NEAR(true_area(b.mesh), 10 * (10 - 5.005), 1e-9);
  const Tin result = surface(b.mesh);
  EXPECT_EQ(wrong_with(result), "");
  EXPECT_DOUBLE_EQ(plan_area(result), 100) << "no gap";
  EXPECT_EQ(result.vertices.size(), 8u);
  Context context;
  EXPECT_EQ(surface(combine(b.mesh, read(negated(tin)).mesh, or_table, Extent::overlap, context).mesh).faces.size(), 2u)
      << "a surface and its NOT leave no sliver between them";
}

TEST(ReadBinary, WhatIsSteepDependsOnTheUnits) {
  const Tin tin = canonical(Tin{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 560}, {2, 1, 560}, {1, 2, 560}},
                                {{0, 1, 2}, {1, 3, 2}, {3, 5, 2}, {1, 4, 3}, {3, 4, 5}}});
  Context context;
  EXPECT_THROW(read(tin), Error);  // one of its faces is not steep enough
  const Slope in_other_units = [](const Point& a, const Point& b, const Point& c) {
    return 1e3 * std::max({a.z, b.z, c.z});
  };
  EXPECT_NO_THROW(read_binary(tin, {0, in_other_units, "input"}, context));
}

TEST(ReadBinary, RefusesWhatIsNotBinary) {
  const auto message = [](const Tin& tin) -> std::string {
    try {
      read(tin);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind, ErrorKind::input);
      EXPECT_EQ(error.code, "not-binary");
      return error.what();
    }
    return "";
  };
  const std::string slope = message(drawn("00\n01"));
  EXPECT_NE(slope.find("face"), std::string::npos);
  EXPECT_NE(slope.find("89.9"), std::string::npos);
  EXPECT_NE(slope.find("'threshold'"), std::string::npos);
  Context context;
  const Tin three = lifted(level_zones(drawn("0123\n0123"), std::vector<double>{1, 2}, context).mesh,
                           std::vector<double>{0, 5, 9}, context)
                        .tin;
  EXPECT_NE(message(three).find("at 5, between the levels 0 and 9"), std::string::npos) << message(three);
}

TEST(Combine, OfBlocks) {
  const Tin a = blocks(10, {{1, 1, 6, 6}}), b = blocks(10, {{4, 4, 9, 9}});
  EXPECT_DOUBLE_EQ(true_area(combined(a, b, and_table).mesh), 4);
  EXPECT_DOUBLE_EQ(true_area(combined(a, b, or_table).mesh), 46);
  EXPECT_DOUBLE_EQ(true_area(combined(a, b, xor_table).mesh), 42);
  EXPECT_DOUBLE_EQ(true_area(combined(a, b, nand_table).mesh), 96);
  EXPECT_DOUBLE_EQ(true_area(combined(a, b, nor_table).mesh), 54);
  EXPECT_EQ(combined(a, b, or_table).mesh.points.size(), 4u + 8u);
}

TEST(Combine, TouchingCornersNestedRingsAndSharedBorders) {
  const Tin ring = blocks(10, {{1, 1, 9, 9}}), checked = blocks(10, {{1, 1, 5, 5}, {5, 5, 9, 9}}),
            other = blocks(10, {{5, 1, 9, 5}, {1, 5, 5, 9}}), core = blocks(10, {{3, 3, 7, 7}});
  EXPECT_DOUBLE_EQ(true_area(combined(checked, other, or_table).mesh), 64);
  EXPECT_EQ(combined(checked, other, or_table).mesh.points.size(), 8u) << "the block of 8 by 8, and the domain";
  EXPECT_DOUBLE_EQ(true_area(combined(checked, other, and_table).mesh), 0);
  const Tin chess = operated(checked, core, xor_table);
  EXPECT_EQ(wrong_with(chess), "");
  const Tin nested = operated(ring, core, xor_table);
  const Tin deeper = operated(nested, blocks(10, {{4, 4, 6, 6}}), or_table);
  EXPECT_DOUBLE_EQ(true_area(read(deeper).mesh), 64 - 16 + 4);
  EXPECT_EQ(operated(deeper, deeper, xor_table).faces.size(), 2u);
  EXPECT_EQ(operated(deeper, deeper, and_table), deeper);
}

TEST(Combine, UnknownStaysOut) {
  const Tin a = binary("1111\n1111\n1111"), b = binary("0000\n0110\n0110\n0000", {1, 0});
  const Combined overlap = combined(a, b, or_table);
  EXPECT_DOUBLE_EQ(plan_area(surface(overlap.mesh)), 4);
  const Combined box = combined(a, b, nand_table, Extent::box);
  EXPECT_DOUBLE_EQ(plan_area(surface(box.mesh)), 12);
  EXPECT_DOUBLE_EQ(true_area(box.mesh), 12 - 1);
  const Tin far = binary("11\n11", {20, 5});
  EXPECT_TRUE(combined(a, far, and_table).mesh.faces.empty());
  const Combined apart = combined(a, far, or_table, Extent::box);
  EXPECT_DOUBLE_EQ(plan_area(surface(apart.mesh)), 21 * 6);
  EXPECT_DOUBLE_EQ(true_area(apart.mesh), 6 + 1);
}

/// A random binary surface: a terrain above its level.
Tin random_binary(int points, std::uint64_t seed, double level = 0) {
  Context context;
  return surface(level_zones(support::random_terrain(points, seed), std::vector<double>{level}, context).mesh);
}

/// -1 where there is no surface, or the place is too near an edge.
int truth(const support::Sampler& sampler, Point2 at) {
  const double z = sampler(at);
  return std::isnan(z) || !sampler.clear_of_edges(at, 1e-6) ? -1 : z > 127 ? 1 : 0;
}

TEST(Combine, TablesHoldAtRandomPlaces) {
  const Tin a = support::with_holes(support::random_terrain(3000, 21)),
            b = support::rotated(support::islands(support::random_terrain(3000, 22)), 30);
  Context context;
  const auto above = [&](const Tin& tin, double level) {
    return surface(level_zones(canonical(tin), std::vector<double>{level}, context).mesh);
  };
  const Tin p = above(a, 0), q = above(b, 3);
  const support::Sampler at_p(p), at_q(q);
  const char* count = std::getenv("TERRANE_PLACES");
  const auto places = support::random_places(bounds(p), count ? std::atoi(count) : 5000, 4);
  for (const auto& table : {and_table, or_table, xor_table, nand_table, nor_table}) {
    for (const Extent extent : {Extent::overlap, Extent::box}) {
      const support::Sampler result(operated(p, q, table, extent));
      std::size_t judged = 0;
      for (const Point2 at : places) {
        const int r = truth(result, at);
        const bool in_p = !std::isnan(at_p(at)), in_q = !std::isnan(at_q(at));
        const int x = in_p ? truth(at_p, at) : 0, y = in_q ? truth(at_q, at) : 0;
        if (x < 0 || y < 0) continue;
        if (extent == Extent::overlap && !(in_p && in_q)) {
          ASSERT_EQ(r, -1);
        } else if (r >= 0) {
          ASSERT_EQ(r, table[2 * x + y]) << at.x << " " << at.y;
          ++judged;
        }
      }
      EXPECT_GT(judged, places.size() / 8);
      if (count) std::printf("%zu places judged\n", judged);
    }
  }
}

TEST(Combine, DeMorganToTheLastBit) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Tin a = random_binary(400, seed), b = random_binary(300, 100 + seed, 4);
    EXPECT_EQ(level_parts(negated(operated(a, b, and_table))), level_parts(operated(negated(a), negated(b), or_table)))
        << seed;
    EXPECT_EQ(level_parts(negated(operated(a, b, or_table))), level_parts(operated(negated(a), negated(b), and_table)))
        << seed;
    EXPECT_EQ(level_parts(negated(operated(a, b, and_table))), level_parts(operated(a, b, nand_table))) << seed;
    EXPECT_EQ(negated(negated(a)), a);
  }
}

TEST(Combine, DoesNotDependOnTheOrder) {
  const Tin a = random_binary(500, 31), b = support::shifted(random_binary(500, 32), 1234.5, 678.9);
  for (const auto& table : {and_table, or_table, xor_table, nand_table, nor_table})
    for (const Extent extent : {Extent::overlap, Extent::box})
      EXPECT_EQ(operated(a, b, table, extent), operated(b, canonical(support::shuffled(a, 3)), table, extent));
}

TEST(Combine, KeepsNoVertexThatBordersDoNotNeed) {
  // Edges inside the areas cross the borders of the other, and must leave nothing behind.
  const Tin a = support::rotated(blocks(1000, {{100, 100, 600, 560}}), 17.3, {500, 500}),
            b = support::rotated(blocks(1000, {{400, 400, 900, 900}}), 17.3, {500, 500});
  EXPECT_EQ(combined(canonical(a), canonical(b), or_table).mesh.points.size(), 4u + 8u);
}

TEST(Combine, OfLargeSurfacesTakesSeconds) {
  const Tin a = random_binary(150000, 41), b = random_binary(150000, 42, 2);
  const Inspection seen = inspect(surface(combined(a, b, xor_table).mesh));
  EXPECT_EQ(seen.inverted + seen.degenerate + seen.t_junctions + seen.non_manifold_edges + seen.overlaps, 0u);
}

}  // namespace
}  // namespace terrane
