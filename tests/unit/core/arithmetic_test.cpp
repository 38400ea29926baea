// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/arithmetic.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "support/checks.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::drawn;
using support::open_seams;
using support::Sampler;
using support::wrong_with;

Assembled combined(const Tin& a, const Tin& b, int sign, Outside outside, Seam seam = Seam::wall) {
  Context context;
  return combine(a, b, sign, outside, {seam, 0}, context);
}

const Tin low = drawn(
    "111\n"
    "111\n"
    "111");
const Tin high = drawn(
    "345\n"
    "345\n"
    "345",
    1, {1, 0});

TEST(Combine, SumOnTheOverlapAndTheLoneSurfaceOutside) {
  const Tin sum = combined(low, high, 1, Outside::keep).tin;
  EXPECT_EQ(wrong_with(sum), "");
  EXPECT_EQ(open_seams(sum), "");
  const Sampler z(sum);
  EXPECT_EQ(z({0.5, 1.3}), 1);
  EXPECT_DOUBLE_EQ(z({1.5, 1.3}), 1 + 3.5);
  EXPECT_DOUBLE_EQ(z({2.5, 1.3}), 4.5);
}

/// A surface with a wall along its southern side whose other edge, at the height z, no face but the wall has.
Tin with_skirt(Tin tin, double z) {
  const Index first = static_cast<Index>(tin.vertices.size());
  Index west = 0, east = 0;
  for (Index v = 0; v < first; ++v) {
    const Point p = tin.vertices[v];
    if (p.y != 0) continue;
    if (p.x < tin.vertices[west].x || tin.vertices[west].y != 0) west = v;
    if (p.x > tin.vertices[east].x || tin.vertices[east].y != 0) east = v;
  }
  for (const Index v : {west, east}) tin.vertices.push_back({tin.vertices[v].x, tin.vertices[v].y, z});
  tin.faces.push_back({east, west, first});
  tin.faces.push_back({east, first, first + 1});
  return tin;
}

TEST(Combine, SkirtsAndParapetsLeaveTheHeightsAlone) {
  const Tin plane = drawn("14\n14", 1);
  const Tin sum = combined(plane, low, 1, Outside::drop).tin;
  for (const double z : {-5.0, 9.0}) {
    const Tin skirted = with_skirt(plane, z);
    for (const Tin& a : {skirted, canonical(skirted)}) {
      const Sampler got(combined(a, low, 1, Outside::drop).tin), want(sum);
      for (const Point2 p : {Point2{0.1, 0.05}, {0.5, 0.01}, {0.9, 0.2}, {0.3, 0.8}}) EXPECT_EQ(got(p), want(p));
    }
  }
}

TEST(Combine, WallsStandAroundTheOverlap) {
  // At x = 1: from 1 to 4 over two units; at x = 2: from 5 down to 4.
  EXPECT_DOUBLE_EQ(combined(low, high, 1, Outside::keep).wall_area, 2 * 3 + 2 * 1);
  EXPECT_EQ(combined(low, high, 1, Outside::keep, Seam::split).wall_area, 0);
}

TEST(Combine, DropKeepsTheOverlapOnly) {
  const Tin sum = combined(low, high, 1, Outside::drop).tin;
  EXPECT_EQ(bounds(sum).xmin, 1);
  EXPECT_EQ(bounds(sum).xmax, 2);
  EXPECT_EQ(wrong_with(sum), "");
}

TEST(Combine, ZeroTakesTheMissingSurfaceAsNothing) {
  const Tin difference = combined(low, high, -1, Outside::zero).tin;
  const Sampler z(difference);
  EXPECT_EQ(z({0.5, 1.3}), 1);
  EXPECT_DOUBLE_EQ(z({1.5, 1.3}), 1 - 3.5);
  EXPECT_DOUBLE_EQ(z({2.5, 1.3}), -4.5);
  EXPECT_EQ(open_seams(difference), "");
}

TEST(Combine, ADifferenceHasNoLoneSurface) {
  Context context;
  EXPECT_THROW(combine(low, high, -1, Outside::keep, {}, context), Error);
}

TEST(Combine, ApartNothingIsLeft) {
  EXPECT_TRUE(combined(low, support::shifted(low, 100, 0), -1, Outside::drop).tin.faces.empty());
}

TEST(Combine, DifferenceWithItselfIsZero) {
  const Tin a = support::random_terrain(300, 3);
  const Tin zero = combined(a, a, -1, Outside::drop).tin;
  EXPECT_EQ(zero.faces.size(), a.faces.size());
  for (const Point& p : zero.vertices) EXPECT_EQ(p.z, 0);
}

TEST(Offset, MovesEveryVertexAndNothingElse) {
  const Tin lifted = offset(high, 2.5);
  EXPECT_EQ(lifted.faces, high.faces);
  for (std::size_t v = 0; v < high.vertices.size(); ++v) {
    EXPECT_EQ(plan(lifted.vertices[v]), plan(high.vertices[v]));
    EXPECT_EQ(lifted.vertices[v].z, high.vertices[v].z + 2.5);
  }
}

}  // namespace
}  // namespace terrane
