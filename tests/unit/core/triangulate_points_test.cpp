// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/triangulate_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "core/error.hpp"
#include "core/validate.hpp"
#include "core/volume.hpp"

namespace terrane {
namespace {

Survey survey(std::vector<Point> points, const std::vector<Line>& lines = {}, SurveyOptions options = {}) {
  Context context;
  Survey made = triangulate_points(std::move(points), lines, options, context);
  EXPECT_EQ(checked(made.tin, "survey", context), made.tin) << "valid and canonical";
  return made;
}

std::string refusal(const std::vector<Point>& points, const std::vector<Line>& lines = {}) {
  try {
    survey(points, lines);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::input);
    return error.code;
  }
  return "";
}

bool has_edge(const Tin& tin, Point2 a, Point2 b) {
  for (const Face& f : tin.faces)
    for (int k = 0; k < 3; ++k) {
      const Point2 p = plan(tin.vertices[f[k]]), q = plan(tin.vertices[f[(k + 1) % 3]]);
      if ((p == a && q == b) || (p == b && q == a)) return true;
    }
  return false;
}

std::vector<Point> random_points(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Point> points;
  for (int i = 0; i < count; ++i) {
    const double x = 500000 + static_cast<double>(random() % 100000) / 100,
                 y = 4e6 + static_cast<double>(random() % 100000) / 100;
    points.push_back({x, y, std::sin(x / 50) * 10 + y / 100});
  }
  return points;
}

const std::vector<Point> square = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};

TEST(TriangulatePoints, EveryPointIsAVertexAndTheDomainIsTheHull) {
  const auto points = random_points(20000, 1);
  const Survey made = survey(points);
  std::set<std::pair<double, double>> places;
  for (const Point& p : points) places.insert({p.x, p.y});
  EXPECT_EQ(made.tin.vertices.size(), places.size());
  EXPECT_EQ(made.duplicates, points.size() - places.size());
}

TEST(TriangulatePoints, TheOrderOfPointsAndLinesDoesNotMatter) {
  auto points = random_points(2000, 2);
  std::vector<Line> lines;
  for (int i = 0; i < 40; ++i) {  // on one plane, so that they may cross
    const Point &a = points[2 * i], &b = points[2 * i + 1];
    lines.push_back({{a.x + 0.5, a.y, 7}, {b.x + 0.5, b.y + 0.25, 7}});
  }
  const Survey first = survey(points, lines);
  EXPECT_GT(first.crossings, 10u);
  std::shuffle(points.begin(), points.end(), std::mt19937(3));
  std::shuffle(lines.begin(), lines.end(), std::mt19937(4));
  for (Line& line : lines) std::swap(line[0], line[1]);
  EXPECT_EQ(survey(points, lines).tin, first.tin);
}

TEST(TriangulatePoints, BreaklinesAreEdges) {
  const std::vector<Point> points = {{0, 0, 0}, {10, 0, 0}, {5, 1, 5}, {5, -1, -5}};
  EXPECT_FALSE(has_edge(survey(points).tin, {0, 0}, {10, 0}));
  EXPECT_TRUE(has_edge(survey(points, {{{0, 0, 0}, {10, 0, 0}}}).tin, {0, 0}, {10, 0}));
}

TEST(TriangulatePoints, APointOnABreaklineDividesIt) {
  auto points = square;
  points.push_back({2, 2, 9});
  const Tin tin = survey(points, {{{0, 0, 0}, {4, 4, 0}}}).tin;
  EXPECT_TRUE(has_edge(tin, {0, 0}, {2, 2}));
  EXPECT_TRUE(has_edge(tin, {2, 2}, {4, 4}));
}

TEST(TriangulatePoints, BreaklinesThatMeetAtOneHeightCross) {
  const Survey made = survey(square, {{{0, 1, 1}, {4, 2, 3}}, {{1, 0, 13.0 / 7}, {3, 4, 13.0 / 7}}});
  EXPECT_EQ(made.crossings, 1u);
  const auto at = std::find_if(made.tin.vertices.begin(), made.tin.vertices.end(),
                               [](const Point& p) { return p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; });
  ASSERT_NE(at, made.tin.vertices.end());
  EXPECT_NEAR(at->z, 13.0 / 7, 1e-12);
}

TEST(TriangulatePoints, WhatContradictsItselfIsRefusedOrAveraged) {
  auto points = square;
  points.push_back({4, 4, 2});
  EXPECT_EQ(refusal(points), "different-heights");
  const Survey made = survey(points, {}, {.average = true});
  EXPECT_EQ(made.averaged, 1u);
  EXPECT_TRUE(std::any_of(made.tin.vertices.begin(), made.tin.vertices.end(), [](const Point& p) {
    return p == Point{4, 4, 1};
  }));
  EXPECT_EQ(refusal(square, {{{0, 1, 1}, {4, 1, 1}}, {{1, 0, 5}, {1, 4, 5}}}), "different-heights");
  EXPECT_EQ(refusal(square, {{{0, 1, NAN}, {4, 1, 1}}}), "no-height");
  EXPECT_EQ(refusal({{0, 0, 0}, {1, 1, 0}, {2, 2, 0}}), "too-few-points");
  EXPECT_EQ(refusal({}), "too-few-points");
}

TEST(TriangulatePoints, ACornerWithoutAHeightTakesThatOfItsPoint) {
  const Tin tin = survey(square, {{{0, 0, NAN}, {4, 4, NAN}}}).tin;
  EXPECT_TRUE(has_edge(tin, {0, 0}, {4, 4}));
}

TEST(TriangulatePoints, LongEdgesArePeeledFromTheBorderOnly) {
  std::vector<Point> points;  // a ring of points around an empty middle, and one far away
  for (int i = 0; i < 48; ++i) points.push_back({10 * std::cos(i * 0.1309), 10 * std::sin(i * 0.1309), 0});
  points.push_back({40, 0, 0});
  const Survey made = survey(points, {}, {.max_edge = 21});
  EXPECT_EQ(made.left_out, 1u);
  EXPECT_NEAR(plan_area(made.tin), 313, 2);
}

}  // namespace
}  // namespace terrane
