// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/contour.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>
#include <set>

#include "core/error.hpp"
#include "core/merge.hpp"
#include "support/checks.hpp"
#include "support/small_mesh.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::drawn;
using support::Sampler;

std::vector<Contour> traced(const Tin& tin, std::vector<double> levels, int threads = 1) {
  Context context;
  context.threads = threads;
  return contours(tin, levels, context);
}

/// Twice the area to the right of closed lines.
double area2_on_the_right(const std::vector<Contour>& lines) {
  double sum = 0;
  for (const Contour& c : lines)
    for (std::size_t i = 0; i + 1 < c.line.size(); ++i)
      sum -= c.line[i].x * c.line[i + 1].y - c.line[i].y * c.line[i + 1].x;
  return sum;
}

double length(const std::vector<Contour>& lines) {
  double sum = 0;
  for (const Contour& c : lines)
    for (std::size_t i = 0; i + 1 < c.line.size(); ++i)
      sum += std::hypot(c.line[i + 1].x - c.line[i].x, c.line[i + 1].y - c.line[i].y);
  return sum;
}

Point at_level(const Point& a, const Point& b, double level) {
  const double t = (level - a.z) / (b.z - a.z);
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), level};
}

/// The length of a level's contour, face by face and edge by edge: the definition written out. For surfaces without
/// jumps.
double expected_length(const Tin& tin, double level) {
  double sum = 0;
  std::map<std::pair<Index, Index>, std::vector<double>> level_edges;  // the third heights beside an edge at the level
  for (const Face& f : tin.faces) {
    std::vector<Point> ends;
    bool above = false, below = false;
    for (int k = 0; k < 3; ++k) {
      const Point &a = tin.vertices[f[k]], &b = tin.vertices[f[(k + 1) % 3]];
      above = above || a.z > level, below = below || a.z < level;
      if (a.z == level) ends.push_back(a);
      if ((a.z < level && b.z > level) || (a.z > level && b.z < level)) ends.push_back(at_level(a, b, level));
      if (a.z == level && b.z == level)
        level_edges[std::minmax(f[k], f[(k + 1) % 3])].push_back(tin.vertices[f[(k + 2) % 3]].z);
    }
    if (above && below && ends.size() == 2) sum += std::hypot(ends[0].x - ends[1].x, ends[0].y - ends[1].y);
  }
  for (const auto& [edge, thirds] : level_edges)
    if (thirds.size() == 2 && (thirds[0] >= level) != (thirds[1] >= level)) {
      const Point &a = tin.vertices[edge.first], &b = tin.vertices[edge.second];
      sum += std::hypot(a.x - b.x, a.y - b.y);
    }
  return sum;
}

/// On the surface, higher ground on the right, ends at the border alone, each piece once.
void expect_right(const Tin& tin, const std::vector<Contour>& lines, double level) {
  const Sampler z(tin);
  std::set<std::pair<double, double>> border;
  std::map<std::pair<Index, Index>, int> edges;
  for (const Face& f : tin.faces)
    for (int k = 0; k < 3; ++k) ++edges[std::minmax(f[k], f[(k + 1) % 3])];
  const auto at_border = [&](const Point& p) {
    for (const auto& [edge, count] : edges) {
      const Point &a = tin.vertices[edge.first], &b = tin.vertices[edge.second];
      if (count == 1 && std::hypot(p.x - a.x, p.y - a.y) + std::hypot(p.x - b.x, p.y - b.y) <=
                            std::hypot(a.x - b.x, a.y - b.y) * (1 + 1e-12))
        return true;
    }
    return false;
  };
  std::set<std::array<double, 4>> pieces;
  for (const Contour& c : lines) {
    EXPECT_EQ(c.level, level);
    EXPECT_EQ(c.closed, c.line.front() == c.line.back() && c.line.size() > 2);
    if (!c.closed) {
      EXPECT_TRUE(at_border(c.line.front()) && at_border(c.line.back())) << c.line.front().x << " " << c.line.front().y;
    }
    for (std::size_t i = 0; i + 1 < c.line.size(); ++i) {
      const Point &p = c.line[i], &q = c.line[i + 1];
      EXPECT_EQ(p.z, level);
      if (const double on = z({p.x, p.y}); !std::isnan(on)) {
        EXPECT_NEAR(on, level, 1e-9);
      }
      EXPECT_TRUE(pieces.insert({p.x, p.y, q.x, q.y}).second);
      EXPECT_FALSE(pieces.contains({q.x, q.y, p.x, p.y})) << "there and back";
      const double d = std::hypot(q.x - p.x, q.y - p.y), aside = 1e-7;
      if (d < 1e-3) continue;
      const Point2 middle{(p.x + q.x) / 2, (p.y + q.y) / 2}, right{(q.y - p.y) / d * aside, (p.x - q.x) / d * aside};
      const double higher = z({middle.x + right.x, middle.y + right.y}),
                   lower = z({middle.x - right.x, middle.y - right.y});
      if (!std::isnan(higher)) {
        EXPECT_GE(higher, level - 1e-12);
      }
      if (!std::isnan(lower)) {
        EXPECT_LT(lower, level + 1e-12);
      }
    }
  }
  EXPECT_NEAR(length(lines), expected_length(tin, level), 1e-9 * (1 + expected_length(tin, level)));
}

/// Twice the area in plan where a surface is at or above a level, face by face.
double area2_above(const Tin& tin, double level) {
  double sum = 0;
  for (const Face& f : tin.faces) {
    std::vector<Point> kept;
    for (int k = 0; k < 3; ++k) {
      const Point &a = tin.vertices[f[k]], &b = tin.vertices[f[(k + 1) % 3]];
      if (a.z >= level) kept.push_back(a);
      if ((a.z >= level) != (b.z >= level)) kept.push_back(at_level(a, b, level));
    }
    for (std::size_t i = 2; i < kept.size(); ++i)
      sum +=
          (kept[i - 1].x - kept[0].x) * (kept[i].y - kept[0].y) - (kept[i - 1].y - kept[0].y) * (kept[i].x - kept[0].x);
  }
  return sum;
}

/// The same from its outline: the contours, and the border of the domain as far as it is as high.
double area2_within(const Tin& tin, const std::vector<Contour>& lines, double level) {
  std::map<std::array<double, 4>, std::array<Point, 3>> border;
  for (const Face& f : tin.faces)
    for (int k = 0; !is_wall(tin, f) && k < 3; ++k) {
      const Point &a = tin.vertices[f[k]], &b = tin.vertices[f[(k + 1) % 3]];
      if (border.erase({b.x, b.y, a.x, a.y}) == 0) border[{a.x, a.y, b.x, b.y}] = {a, b, tin.vertices[f[(k + 2) % 3]]};
    }
  double sum = area2_on_the_right(lines);
  for (auto [key, edge] : border) {
    auto [a, b, third] = edge;
    if ((a.z < level && b.z < level) || (a.z == level && b.z == level && third.z < level)) continue;
    if (a.z < level) a = at_level(a, b, level);
    if (b.z < level) b = at_level(b, a, level);
    sum += a.x * b.y - a.y * b.x;
  }
  return sum;
}

TEST(Contour, EnclosesTheAreaAtAndAboveTheLevel) {
  support::Random random(11);
  for (int round = 0; round < 60; ++round) {
    std::vector<Tin> tiles;
    for (int i = 0; i < 3; ++i) {
      std::string picture;
      for (int y = 0; y < 6; ++y, picture += '\n')
        for (int x = 0; x < 6; ++x) picture += support::below(random, 15) == 0 ? '.' : '0' + support::below(random, 5);
      const double shift = round % 2 ? 0.5 : 0.25;
      tiles.push_back(
          canonical(drawn(picture, 1, {shift * support::below(random, 9), shift * support::below(random, 9)})));
      if (tiles.back().faces.empty()) tiles.pop_back();
    }
    Context context;
    const Tin tin = merge(tiles, {Overlap::first, {Seam::wall, 0}}, context).surface.tin;
    for (const double level : {0.0, 1.0, 1.7, 2.0, 3.0, 4.0}) {
      const auto lines = traced(tin, {level});
      EXPECT_NEAR(area2_within(tin, lines, level), area2_above(tin, level), 1e-9)
          << "round " << round << " level " << level;
      std::set<std::array<double, 4>> pieces;
      for (const Contour& c : lines)
        for (std::size_t i = 0; i + 1 < c.line.size(); ++i) {
          const Point &p = c.line[i], &q = c.line[i + 1];
          EXPECT_TRUE(pieces.insert({p.x, p.y, q.x, q.y}).second);
          EXPECT_FALSE(pieces.contains({q.x, q.y, p.x, p.y})) << "there and back";
        }
    }
  }
}

TEST(Contour, APyramid) {
  const Tin tin = drawn("000\n020\n000");
  const auto lines = traced(tin, {1});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_TRUE(lines[0].closed);
  expect_right(tin, lines, 1);
  EXPECT_GT(area2_on_the_right(lines), 0) << "the top is on the right: clockwise";
}

TEST(Contour, WhatOnlyTouchesTheLevelIsNone) {
  EXPECT_TRUE(traced(drawn("000\n020\n000"), {2}).empty()) << "a peak";
  EXPECT_TRUE(traced(drawn("000\n222\n000"), {2}).empty()) << "a ridge";
  EXPECT_TRUE(traced(drawn("222\n222\n222"), {2}).empty()) << "the border of the domain";
  EXPECT_TRUE(traced(drawn("222\n202\n222"), {0}).empty()) << "a pit: all is at or above";
  EXPECT_TRUE(traced(drawn("222\n000\n222"), {0}).empty()) << "a valley";
  EXPECT_TRUE(traced(drawn("222\n202\n222"), {3, 4, -1}).empty());
  EXPECT_TRUE(traced({}, {3}).empty());
}

TEST(Contour, FlatGroundHasItsBorder) {
  const Tin plateau = drawn("00000\n02220\n02220\n02220\n00000");
  const auto top = traced(plateau, {2});
  ASSERT_EQ(top.size(), 1u);
  EXPECT_EQ(top[0].line.size(), 9u);
  EXPECT_EQ(area2_on_the_right(top), 2 * 4);
  expect_right(plateau, top, 2);
  EXPECT_TRUE(traced(plateau, {0}).empty()) << "flat at the level, and higher: one area";
  const Tin basin = drawn("22222\n20002\n20002\n20002\n22222");
  EXPECT_TRUE(traced(basin, {0}).empty());
  const Tin step = drawn("0022\n0022\n0022");
  const auto edge = traced(step, {2});
  ASSERT_EQ(edge.size(), 1u);
  EXPECT_FALSE(edge[0].closed);
  EXPECT_EQ(edge[0].line.size(), 3u);
  EXPECT_EQ(edge[0].line.front(), (Point{2, 0, 2})) << "northwards, the higher east on the right";
}

TEST(Contour, ARidgeThatLeavesAPlateauIsLeftOut) {
  const Tin tin = drawn(
      "0000000\n"
      "0222000\n"
      "0222220\n"
      "0222000\n"
      "0000000");
  const auto lines = traced(tin, {2});
  ASSERT_EQ(lines.size(), 1u);
  expect_right(tin, lines, 2);
}

TEST(Contour, AreasThatTouchInAPointStayApart) {
  const Tin tin = drawn(
      "33000\n"
      "33000\n"
      "00200\n"
      "00033\n"
      "00033");
  for (const double level : {1.0, 2.0, 3.0}) expect_right(tin, traced(tin, {level}), level);
  const Tin saddle = drawn(
      "00000\n"
      "00300\n"
      "03230\n"
      "00300\n"
      "00000");
  for (const double level : {1.0, 2.0, 3.0, 2.5}) expect_right(saddle, traced(saddle, {level}), level);
}

TEST(Contour, LatticesOfFewHeightsAtTheirHeights) {
  support::Random random(3);
  for (int round = 0; round < 300; ++round) {
    std::string picture;
    for (int j = 0; j < 8; ++j, picture += '\n')
      for (int i = 0; i < 9; ++i)
        picture += support::below(random, 12) == 0 && round % 2 ? '.' : '0' + support::below(random, 3);
    const Tin tin = canonical(drawn(picture));
    if (tin.faces.empty()) continue;
    for (const double level : {0.0, 0.5, 1.0, 2.0}) expect_right(tin, traced(tin, {level}), level);
    if (testing::Test::HasFailure()) FAIL() << picture;
  }
}

TEST(Contour, RandomTerrain) {
  for (const Tin& tin : {support::random_terrain(400, 2), support::with_holes(support::random_terrain(500, 5))}) {
    std::vector<double> heights;
    for (const Point& p : tin.vertices) heights.push_back(p.z);
    std::sort(heights.begin(), heights.end());
    for (const double level : {heights[40], heights[200], 0.5 * (heights[200] + heights[201]), heights[350]})
      expect_right(tin, traced(tin, {level}), level);
  }
}

Tin tower(Seam seam) {
  const Tin low = canonical(drawn("000000\n000000\n000000\n000000\n000000\n000000"));
  const Tin high = canonical(drawn("777\n777\n777", 1, {1.5, 1.5}));
  Context context;
  return merge({high, low}, {Overlap::first, {seam, 0}}, context).surface.tin;
}

TEST(Contour, AWallGivesItsLineOnce) {
  for (const double level : {0.5, 3.0, 7.0}) {
    const auto lines = traced(tower(Seam::wall), {level});
    ASSERT_EQ(lines.size(), 1u) << level;
    EXPECT_TRUE(lines[0].closed);
    EXPECT_EQ(area2_on_the_right(lines), 2 * 4);
    EXPECT_EQ(length(lines), 8);
  }
  EXPECT_TRUE(traced(tower(Seam::wall), {0, 8}).empty());
  EXPECT_TRUE(traced(tower(Seam::split), {3}).empty()) << "there is no surface at that height";
}

TEST(Contour, AContourThatClimbsAWall) {
  // A ramp to the east with a raised half: contours run north on the low side, along the wall, and on.
  const Tin low = canonical(drawn("01234\n01234\n01234"));
  const Tin high = canonical(drawn("23456\n23456\n23456", 1, {0, 2}));
  Context context;
  const Tin both = merge({low, high}, {Overlap::first, {Seam::wall, 0}}, context).surface.tin;
  for (const double level : {2.25, 2.5, 3.0, 3.75}) {
    const auto lines = traced(both, {level});
    ASSERT_EQ(lines.size(), 1u) << level;
    EXPECT_FALSE(lines[0].closed);
    EXPECT_NEAR(length(lines), 6, 1e-12) << "two up, two along the wall, two up";
    EXPECT_EQ(lines[0].line.front().y, 0);
    EXPECT_EQ(lines[0].line.back().y, 4);
  }
  EXPECT_NEAR(length(traced(both, {2})), 4, 1e-12) << "above, all is as high";
  // Both sides rise against each other: at the level of their meeting the wall shrinks to a point.
  const Tin falling = canonical(drawn("43210\n43210\n43210", 1, {0, 2}));
  const Tin crossed = merge({low, falling}, {Overlap::first, {Seam::wall, 0}}, context).surface.tin;
  for (const double level : {1.0, 1.5, 2.0, 3.0}) {
    const auto lines = traced(crossed, {level});
    EXPECT_NEAR(length(lines), 4 + 2 * std::min(level, 4 - level), 1e-12) << level;
  }
}

TEST(Contour, TheSameForAnyThreadsAndOrder) {
  const Tin tin = support::random_terrain(3000, 4);
  std::vector<double> levels;
  for (int i = -20; i < 40; ++i) levels.push_back(10 * i);
  const auto lines = traced(tin, levels);
  const auto same = [&](const std::vector<Contour>& others) {
    return std::equal(lines.begin(), lines.end(), others.begin(), others.end(), [](const Contour& a, const Contour& b) {
      return a.level == b.level && a.line == b.line && a.closed == b.closed;
    });
  };
  EXPECT_GT(lines.size(), 30u);
  EXPECT_TRUE(same(traced(tin, levels, 2)));
  EXPECT_TRUE(same(traced(canonical(support::shuffled(tin, 3)), levels)));
}

TEST(Contour, FiftyLevelsOfHalfAMillionFacesTakeSeconds) {
  const Tin tin = support::random_terrain(250000, 6);
  double low = INFINITY, high = -INFINITY;
  for (const Point& p : tin.vertices) low = std::min(low, p.z), high = std::max(high, p.z);
  std::vector<double> levels;
  for (int i = 1; i <= 50; ++i) levels.push_back(low + (high - low) * i / 51);
  const std::clock_t begin = std::clock();
  EXPECT_GT(traced(tin, levels).size(), 50u);
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 5);
}

TEST(Contour, CanBeStopped) {
  Context context;
  context.cancelled = true;
  EXPECT_THROW(contours(support::random_terrain(100, 1), std::vector<double>{10}, context), Error);
}

}  // namespace
}  // namespace terrane
