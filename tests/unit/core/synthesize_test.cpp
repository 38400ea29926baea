// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/synthesize.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/predicates.hpp"
#include "core/volume.hpp"
#include "support/checks.hpp"

namespace terrane {
namespace {

double longest_edge(const Tin& tin) {
  double longest = 0;
  for (const Face& f : tin.faces)
    for (int k = 0; k < 3; ++k) {
      const Point &p = tin.vertices[f[k]], &q = tin.vertices[f[(k + 1) % 3]];
      longest = std::max(longest, std::hypot(q.x - p.x, q.y - p.y));
    }
  return longest;
}

/// In degrees, of the faces in plan.
double smallest_angle(const Tin& tin) {
  double least = 180;
  for (const Face& f : tin.faces)
    for (int k = 0; k < 3; ++k) {
      const Point &a = tin.vertices[f[k]], &b = tin.vertices[f[(k + 1) % 3]], &c = tin.vertices[f[(k + 2) % 3]];
      const double ux = b.x - a.x, uy = b.y - a.y, vx = c.x - a.x, vy = c.y - a.y;
      least = std::min(least, std::atan2(ux * vy - uy * vx, ux * vx + uy * vy) * 180 / std::numbers::pi);
    }
  return least;
}

Tin disc(int samples, double max_edge = 0) {
  return level_area(ellipse({10, 20}, 8, 8, 0, samples), 3, max_edge, Context{});
}

TEST(Synthesize, RectangleIsAPlaneOrARamp) {
  const Tin ramp = rectangle({1, 2, 5, 4}, 10, 30, 0);
  EXPECT_EQ(ramp.faces.size(), 2u);
  EXPECT_DOUBLE_EQ(plan_area(ramp), 8);
  for (const Point& p : ramp.vertices) EXPECT_EQ(p.z, p.x == 1 ? 10 : 30);
  const Tin fine = rectangle({1, 2, 5, 4}, 10, 30, 0.3);
  EXPECT_EQ(support::wrong_with(fine), "");
  EXPECT_LE(longest_edge(fine), 0.3);
  EXPECT_DOUBLE_EQ(plan_area(fine), 8);
  for (const Point& p : fine.vertices) EXPECT_NEAR(p.z, 10 + 5 * (p.x - 1), 1e-12);
}

TEST(Synthesize, CircleIsTheMethodsFormula) {
  const auto ring = ellipse({0, 0}, 2, 2, 0, 20);
  for (int n = 0; n < 20; ++n) {
    EXPECT_NEAR(ring[n].x, std::cos(2 * std::numbers::pi * n / 20), 1e-15);
    EXPECT_NEAR(ring[n].y, std::sin(2 * std::numbers::pi * n / 20), 1e-15);
  }
  const Tin tin = disc(64);
  EXPECT_EQ(tin.vertices.size(), 64u);
  EXPECT_EQ(tin.faces.size(), 62u);
  EXPECT_EQ(support::wrong_with(tin), "");
  EXPECT_NEAR(plan_area(tin), 0.5 * 64 * 16 * std::sin(2 * std::numbers::pi / 64), 1e-12);
  for (const Point& p : tin.vertices) EXPECT_EQ(p.z, 3);
  EXPECT_EQ(disc(3).faces.size(), 1u);
}

TEST(Synthesize, EllipseAxesAreFullLengthsAndAzimuthsTurnItClockwiseFromX) {
  const auto at = [](double azimuth) { return ellipse({5, 5}, 6, 2, azimuth, 4); };
  EXPECT_EQ(at(0), (std::vector<Point2>{{8, 5}, {5, 6}, {2, 5}, {5, 4}}));
  EXPECT_EQ(at(90), (std::vector<Point2>{{5, 2}, {6, 5}, {5, 8}, {4, 5}}));
  EXPECT_EQ(at(180), (std::vector<Point2>{{2, 5}, {5, 4}, {8, 5}, {5, 6}}));
  EXPECT_EQ(at(-270), at(90));
  EXPECT_NEAR(at(-45)[0].x, 5 + 3 / std::numbers::sqrt2, 1e-15);
  EXPECT_NEAR(at(-45)[0].y, 5 + 3 / std::numbers::sqrt2, 1e-15);
}

TEST(Synthesize, SplineOfACircleIsNearlyOne) {
  const auto points = ellipse({100, 200}, 10, 10, 0, 16);
  const auto curve = closed_spline(points, 200);
  EXPECT_EQ(curve.size(), 200u);
  for (const Point2 p : curve) EXPECT_NEAR(std::hypot(p.x - 100, p.y - 200), 5, 4e-4);
  for (const Point2 p : points) EXPECT_NE(std::find(curve.begin(), curve.end(), p), curve.end());
}

TEST(Synthesize, SplineIsSmoothAtItsKnots) {
  const std::vector<Point2> points = {{0, 0}, {10, 1}, {11, 2}, {6, 9}, {-3, 5}};
  const auto curve = closed_spline(points, 50000);
  double sharpest = 0;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const Point2 a = curve[i], b = curve[(i + 1) % curve.size()], c = curve[(i + 2) % curve.size()];
    const double turn = std::atan2((b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x),
                                   (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y));
    sharpest = std::max(sharpest, std::fabs(turn));
  }
  EXPECT_LT(sharpest, 0.01);
  EXPECT_FALSE(self_contact(curve, Context{}));
}

TEST(Synthesize, SplineTakesThreePointsAndRepeatedOnes) {
  const std::vector<Point2> triangle = {{0, 0}, {4, 0}, {1, 3}};
  const auto curve = closed_spline(triangle, 30);
  EXPECT_EQ(closed_spline(std::vector<Point2>{{0, 0}, {0, 0}, {4, 0}, {1, 3}, {1, 3}, {0, 0}}, 30), curve);
  EXPECT_EQ(closed_spline(triangle, 2).size(), 2u);
  EXPECT_THROW(closed_spline(std::vector<Point2>{{0, 0}, {4, 0}, {0, 0}}, 30), Error);
}

TEST(Synthesize, FewerSamplesThanPointsAreSpreadOverTheCurve) {
  const auto curve = closed_spline(ellipse({0, 0}, 2, 2, 0, 40), 10);
  ASSERT_EQ(curve.size(), 10u);
  for (int i = 0; i < 10; ++i) {
    const Point2 p = curve[i], q = curve[(i + 1) % 10];
    EXPECT_NEAR(std::hypot(q.x - p.x, q.y - p.y), 2 * std::sin(std::numbers::pi / 10), 1e-3);
  }
}

TEST(Synthesize, CrossingsAndTouchesAreFound) {
  const auto contact = [](std::vector<Point2> ring) { return self_contact(ring, Context{}); };
  EXPECT_FALSE(contact({{0, 0}, {2, 0}, {2, 2}, {0, 2}}));
  ASSERT_TRUE(contact({{0, 0}, {2, 2}, {2, 0}, {0, 2}}));
  EXPECT_EQ(contact({{0, 0}, {2, 2}, {2, 0}, {0, 2}})->at, (Point2{1, 1}));
  EXPECT_EQ(contact({{0, 0}, {4, 0}, {4, 2}, {2, 0}, {0, 2}})->at, (Point2{2, 0}));          // a corner on an edge
  EXPECT_EQ(contact({{0, 0}, {2, 0}, {1, 1}, {2, 2}, {0, 2}, {1, 1}})->at, (Point2{1, 1}));  // two corners
  EXPECT_TRUE(contact({{0, 0}, {4, 0}, {2, 0}, {2, 2}}));                                    // there and back
}

TEST(Synthesize, MaxEdgeHoldsAndTrianglesAreSensible) {
  for (const double max_edge : {5.0, 1.0, 0.21}) {
    const Tin tin = disc(64, max_edge);
    EXPECT_EQ(support::wrong_with(tin), "");
    EXPECT_LE(longest_edge(tin), max_edge * (1 + 1e-12));
    EXPECT_NEAR(plan_area(tin), plan_area(disc(64)), 1e-10);
    if (max_edge < 5) {
      EXPECT_GT(smallest_angle(tin), 15);
    }
  }
  const std::vector<Point2> l_shape = {{0, 0}, {10, 0}, {10, 1}, {1, 1}, {1, 10}, {0, 10}};
  const Tin tin = level_area(l_shape, 0, 0.3, Context{});
  EXPECT_EQ(support::wrong_with(tin), "");
  EXPECT_LE(longest_edge(tin), 0.3 * (1 + 1e-12));
  EXPECT_DOUBLE_EQ(plan_area(tin), 19);
  EXPECT_GT(smallest_angle(tin), 15);
  EXPECT_EQ(tin, level_area(l_shape, 0, 0.3, Context{}));
}

TEST(Synthesize, TooFineAndTooFlatAreRefused) {
  EXPECT_THROW(rectangle({0, 0, 1, 1}, 0, 0, 1e-6), Error);
  EXPECT_THROW(disc(64, 1e-6), Error);
  EXPECT_THROW(level_area(std::vector<Point2>{{0, 0}, {1, 1}, {2, 2}}, 0, 0, Context{}), Error);
}

TEST(Synthesize, ALargeMeshTakesSeconds) {
  const Tin tin = disc(1000, 0.015);
  EXPECT_GT(tin.faces.size(), 250000u);
  EXPECT_EQ(support::wrong_with(tin), "");
}

}  // namespace
}  // namespace terrane
