// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge/ramp.hpp"

#include <gtest/gtest.h>

#include "core/arithmetic.hpp"
#include "core/volume.hpp"
#include "support/checks.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::drawn;
using support::open_seams;
using support::Sampler;
using support::wrong_with;

Assembled ramped(const Tin& a, const Tin& b, int sign = 1, Outside outside = Outside::keep) {
  Context context;
  return combine(a, b, sign, outside, {Seam::ramp, 0}, context);
}

/// One height at every place: no walls, no open jumps.
std::size_t jumps(const Tin& tin) {
  std::size_t walls = 0;
  for (const Face& f : tin.faces) walls += is_wall(tin, f);
  std::vector<std::pair<double, double>> places;
  for (const Point& p : tin.vertices) places.emplace_back(p.x, p.y);
  std::sort(places.begin(), places.end());
  for (std::size_t i = 1; i < places.size(); ++i) walls += places[i] == places[i - 1];
  return walls;
}

const Tin wide = drawn(
    "1111111\n"
    "1111111\n"
    "1111111\n"
    "1111111\n"
    "1111111\n"
    "1111111\n"
    "1111111");

TEST(Ramp, TheJumpIsASlopeWithinTheFacesTheBorderCuts) {
  const Tin small = drawn("22\n22", 2.5, {1.75, 1.75});
  const Assembled sum = ramped(wide, small);
  EXPECT_EQ(wrong_with(sum.tin), "");
  EXPECT_EQ(jumps(sum.tin), 0u);
  EXPECT_EQ(sum.wall_area, 0);
  const Sampler z(sum.tin);
  EXPECT_EQ(z({2, 3}), 3) << "the overlap's height is untouched";
  EXPECT_EQ(z({1.75001, 3}), 3);
  EXPECT_EQ(z({0.9, 3.1}), 1) << "faces beyond the cut ones are untouched";
  const double between = z({1.4, 3.1});
  EXPECT_GT(between, 1);
  EXPECT_LT(between, 3);
  EXPECT_NEAR(plan_area(sum.ramps), 16 - 2.5 * 2.5, 1);
}

TEST(Ramp, AlongTheBorderItHasTheHeightOfTheOverlap) {
  const Tin bumpy = drawn("1352413\n4124352\n2531425\n1435214\n3215341\n4352143\n1423514");
  const Tin small = drawn("27\n41", 2.5, {1.75, 1.75});
  const Sampler z(ramped(bumpy, small).tin), a(bumpy), b(small);
  constexpr double step = 1e-7;
  for (double t = 1.76; t < 4.25; t += 0.037)
    for (const auto& [in, out] : {std::pair<Point2, Point2>{{1.75 + step, t}, {1.75 - step, t}},
                                  {{4.25 - step, t}, {4.25 + step, t}},
                                  {{t, 1.75 + step}, {t, 1.75 - step}},
                                  {{t, 4.25 - step}, {t, 4.25 + step}}}) {
      EXPECT_NEAR(z(in), a(in) + b(in), 1e-12);
      EXPECT_NEAR(z(out), a(in) + b(in), 1e-4);
    }
}

TEST(Ramp, NoVertexIsMadeAndThoseOutsideKeepTheirHeights) {
  const Tin small = drawn("22\n22", 2.5, {1.75, 1.75});
  const Assembled sum = ramped(wide, small);
  const Sampler b(small);
  for (const Point& p : sum.tin.vertices) EXPECT_EQ(p.z, p.x < 1.75 || p.x > 4.25 || p.y < 1.75 || p.y > 4.25 ? 1 : 3);
}

TEST(Ramp, WholeFacesThatTouchTheBorderSlopeAsTheyAre) {
  const Tin small = drawn("222\n222\n222", 1, {2, 2});
  const Assembled sum = ramped(wide, small), walls = [&] {
    Context context;
    return combine(wide, small, 1, Outside::keep, {}, context);
  }();
  EXPECT_EQ(wrong_with(sum.tin), "");
  EXPECT_EQ(jumps(sum.tin), 0u);
  EXPECT_EQ(sum.tin.vertices.size(), wide.vertices.size());
  EXPECT_GT(walls.tin.vertices.size(), wide.vertices.size());
  const Sampler z(sum.tin);
  EXPECT_DOUBLE_EQ(z({1.5, 3.25}), 2) << "half way from 1 to 3";
}

TEST(Ramp, APartWithoutRoomKeepsItsHeightAndGetsWalls) {
  const Tin holed = support::without(drawn("2222\n2222\n2222\n2222", 1.1, {1.3, 1.3}),
                                     [](Point2 c) { return c.x > 2.4 && c.x < 3.5 && c.y > 2.4 && c.y < 3.5; });
  const Tin coarse = drawn("11\n11", 6);
  const Assembled sum = ramped(coarse, holed);
  EXPECT_EQ(wrong_with(sum.tin), "");
  EXPECT_EQ(open_seams(sum.tin), "");
  EXPECT_NEAR(sum.wall_area, 4 * 1.1 * 2, 1e-9) << "around the hole only";
  const Sampler z(sum.tin);
  EXPECT_DOUBLE_EQ(z({2.9, 3.1}), 1);
}

TEST(Ramp, ALargerHoleSlopesDownInside) {
  const Tin holed = support::without(drawn("222222\n222222\n222222\n222222\n222222\n222222", 1, {0.5, 0.5}),
                                     [](Point2 c) { return c.x > 1.5 && c.x < 4.5 && c.y > 1.5 && c.y < 4.5; });
  const Assembled sum = ramped(wide, holed);
  EXPECT_EQ(wrong_with(sum.tin), "");
  EXPECT_EQ(jumps(sum.tin), 0u);
  const Sampler z(sum.tin);
  EXPECT_EQ(z({3.01, 3.005}), 1);
}

TEST(Ramp, WhereNothingJumpsNothingIsTriangulatedAnew) {
  const Tin zero = drawn("00\n00", 2.5, {1.75, 1.75});
  const Assembled sum = ramped(wide, zero), walls = [&] {
    Context context;
    return combine(wide, zero, 1, Outside::keep, {}, context);
  }();
  EXPECT_EQ(sum.tin, walls.tin);
  EXPECT_TRUE(sum.ramps.faces.empty());
}

TEST(Ramp, LoneSurfacesThatShareABorderMeetInTheMiddle) {
  const Tin low = drawn("111\n111\n111"), high = drawn("5555\n5555\n5555", 1, {2, 0});
  const Assembled sum = ramped(low, high);
  EXPECT_EQ(wrong_with(sum.tin), "");
  EXPECT_EQ(jumps(sum.tin), 0u);
  const Sampler z(sum.tin);
  EXPECT_NEAR(z({1.999999999, 0.4}), 3, 1e-8);
  EXPECT_NEAR(z({2.000000001, 0.4}), 3, 1e-8);
  EXPECT_DOUBLE_EQ(z({0.4, 0.7}), 1);
  EXPECT_DOUBLE_EQ(z({3.5, 0.7}), 5);
}

TEST(Ramp, DifferencesSlopeFromBothSides) {
  const Tin high = drawn("5555\n5555\n5555", 1, {2.5, 0.25});
  const Tin difference = ramped(wide, high, -1, Outside::zero).tin;
  EXPECT_EQ(wrong_with(difference), "");
  const Sampler z(difference);
  EXPECT_DOUBLE_EQ(z({3.1, 1.2}), -4);
  EXPECT_DOUBLE_EQ(z({0.5, 5.5}), 1);
}

TEST(Ramp, AWallOfAnInputStaysAWall) {
  Context context;
  const Tin step = combine(drawn("111\n111\n111\n111\n111", 1, {0, 0}), drawn("555\n555\n555\n555\n555", 1, {2, 0}), 1,
                           Outside::keep, {}, context)
                       .tin;
  const Tin small = drawn("33\n33", 1.5, {1.25, 1.25});
  const Assembled sum = ramped(step, small);
  EXPECT_EQ(wrong_with(sum.tin), "");
  EXPECT_EQ(open_seams(sum.tin), "");
  const Sampler z(sum.tin);
  EXPECT_DOUBLE_EQ(z({1.9, 2.1}), 4);
  EXPECT_DOUBLE_EQ(z({2.1, 2.2}), 8);
  EXPECT_EQ(z({1.9, 0.1}), 1);
  EXPECT_EQ(z({2.1, 0.1}), 5);
}

}  // namespace
}  // namespace terrane
