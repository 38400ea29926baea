// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge/line_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/small_mesh.hpp"

namespace terrane {
namespace {

using support::Random;
using support::uniform;
using Segments = std::vector<LineDistance::Segment>;

double plain(const Segments& lines, Point2 p, Point2 metric) {
  double least = INFINITY;
  for (const auto& [a, b] : lines)
    for (int i = 0; i <= 4000; ++i) {
      const double t = i / 4000.0;
      least = std::min(least,
                       std::hypot((a.x + t * (b.x - a.x) - p.x) * metric.x, (a.y + t * (b.y - a.y) - p.y) * metric.y));
    }
  return least;
}

Segments zigzag(Random& random, int n) {
  Segments lines;
  Point2 at = {0, 0};
  for (int i = 0; i < n; ++i) {
    const Point2 next = {at.x + uniform(random, 0.2, 2), at.y + uniform(random, -1, 1)};
    lines.push_back({at, next});
    at = next;
  }
  return lines;
}

TEST(LineDistance, IsTheLeastOfAllSegments) {
  Random random(1);
  for (const Point2 metric : {Point2{1, 1}, Point2{0.7, 1.3}}) {
    const Segments lines = zigzag(random, 20);
    const LineDistance distance(lines, metric, true);
    for (int i = 0; i < 50; ++i) {
      const Point2 p = {uniform(random, -5, 30), uniform(random, -10, 10)};
      EXPECT_NEAR(distance.at(p, 100), plain(lines, p, metric), 1e-3);
      EXPECT_EQ(distance.at(p, 0.5), std::min(0.5, distance.at(p, 100)));
    }
  }
}

TEST(LineDistance, NamesTheNearestPlace) {
  const Segments lines = {{{0, 0}, {4, 0}}, {{4, 0}, {4, 8}}};
  const auto near = LineDistance(lines, {1, 1}, false).nearest({5, 2});
  EXPECT_EQ(near.segment, 1u);
  EXPECT_EQ(near.t, 0.25);
  EXPECT_EQ(near.distance, 1);
}

TEST(LineDistance, RunsThatAreStraightAreOneLine) {
  Segments lines;
  for (int i = 0; i < 10; ++i) lines.push_back({{i + 0.0, 0}, {i + 1.0, 0}});
  const LineDistance distance(lines, {1, 1}, true);
  const OverTriangle f = distance.over({Point2{2, 1}, {7, 1}, {5, 2}}, {1, 1, 2}, 100);
  EXPECT_LT(f.error(), 1e-12);
  const OverTriangle apart = LineDistance(lines, {1, 1}, false).over({Point2{2, 1}, {7, 1}, {5, 2}}, {1, 1, 2}, 100);
  EXPECT_GT(apart.error(), 0.1);
}

/// Everything that a blend is made of, by its bound and at many places of random triangles.
TEST(LineDistance, BoundsHoldOverTriangles) {
  Random random(7);
  double tightest = INFINITY;
  for (int round = 0; round < 300; ++round) {
    const Segments first = zigzag(random, 12), second = {{{0, 3}, {9, 4}}, {{9, 4}, {20, 2.5}}};
    const LineDistance a(first, {1, 1}, true), b(second, {1, 1}, true);
    const double size = std::pow(10, uniform(random, -2, 0.7)), cap = uniform(random, 0.5, 4);
    const Point2 at = {uniform(random, 0, 12), uniform(random, -1, 3)};
    std::array<Point2, 3> t;
    std::array<double, 3> ua, ub, d;
    for (int k = 0; k < 3; ++k) {
      t[k] = {at.x + uniform(random, -size, size), at.y + uniform(random, -size, size)};
      ua[k] = a.at(t[k], cap), ub[k] = b.at(t[k], cap), d[k] = uniform(random, -3, 3);
    }
    const OverTriangle fa = a.over(t, ua, cap), fb = b.over(t, ub, cap);
    const OverTriangle wide = scaled(fa, 1 / cap), narrow = share(fa, fb);
    const OverTriangle w = smaller(constant(1), larger(wide, narrow));
    const double product = error_of_product(w, d);
    double measured = 0;
    for (int i = 0; i < 400; ++i) {
      double l[3] = {uniform(random, 0, 1), uniform(random, 0, 1), 0};
      if (l[0] + l[1] > 1) l[0] = 1 - l[0], l[1] = 1 - l[1];
      l[2] = 1 - l[0] - l[1];
      const auto mix = [&](const std::array<double, 3>& v) { return l[0] * v[0] + l[1] * v[1] + l[2] * v[2]; };
      const Point2 p = {l[0] * t[0].x + l[1] * t[1].x + l[2] * t[2].x, l[0] * t[0].y + l[1] * t[1].y + l[2] * t[2].y};
      const double da = a.at(p, cap), db = b.at(p, cap);
      for (const auto& [value, f] :
           {std::pair(da, fa), std::pair(db, fb), std::pair(da / cap, wide), std::pair(da / (da + db), narrow),
            std::pair(std::min(1.0, std::max(da / cap, da / (da + db))), w)}) {
        EXPECT_LE(value - mix(f.at), f.up + 1e-9);
        EXPECT_LE(mix(f.at) - value, f.down + 1e-9);
      }
      const double exact = std::min(1.0, std::max(da / cap, da / (da + db))) * mix(d);
      const double linear = l[0] * w.at[0] * d[0] + l[1] * w.at[1] * d[1] + l[2] * w.at[2] * d[2];
      measured = std::max(measured, std::fabs(exact - linear));
      EXPECT_LE(std::fabs(exact - linear), product + 1e-9);
    }
    if (product > 1e-6) tightest = std::min(tightest, product / std::max(measured, 1e-300));
  }
  EXPECT_LT(tightest, 3) << "a bound that is never near what it bounds is of no use";
}

}  // namespace
}  // namespace terrane
