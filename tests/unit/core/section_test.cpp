// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/section.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/triangulate.hpp"
#include "tests/support/ascii_raster.hpp"

using namespace terrane;
using terrane::testing::ascii_raster;

namespace {

Tin tin_of(const Raster& dem) {
  Context context;
  return triangulate(dem, {}, context).tin;
}

Section section_of(const std::vector<Tin>& tins, const std::vector<Point2>& line) {
  std::vector<FaceGrid> grids;
  grids.reserve(tins.size());
  for (const Tin& tin : tins) grids.emplace_back(tin);
  std::vector<const FaceGrid*> pointers;
  for (const FaceGrid& grid : grids) pointers.push_back(&grid);
  Context context;
  return section(line, pointers, context);
}

/// "x,y:z" per row, '-' for no surface.
std::string written(const Section& s) {
  std::string text;
  for (std::size_t k = 0; k < s.rows.size(); ++k) {
    char part[80];
    std::snprintf(part, sizeof part, "%s%g,%g:", k ? " " : "", s.rows[k].at.x, s.rows[k].at.y);
    text += part;
    for (std::size_t i = 0; i < s.surfaces; ++i) {
      const double z = s.height(k, i);
      std::snprintf(part, sizeof part, "%s%g", i ? "/" : "", z);
      text += std::isnan(z) ? (i ? "/-" : "-") : part;
    }
  }
  return text;
}

Tin random_tin(std::mt19937_64& random, int n) {
  std::uniform_real_distribution<double> height(0, 50);
  Raster dem;
  dem.width = dem.height = n;
  dem.dx = 1.25, dem.dy = 0.75;
  dem.x0 = 450000.3, dem.y0 = 4380000.7;
  for (int k = 0; k < n * n; ++k) dem.samples.push_back(k % 17 == 5 ? NAN : height(random));
  return tin_of(dem);
}

}  // namespace

TEST(Section, EveryEdgeCrossedIsAStation) {
  // Two faces; their diagonal is crossed in the middle.
  const Tin tin{{{0, 0, 0}, {10, 0, 0}, {10, 10, 10}, {0, 10, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  EXPECT_EQ(written(section_of({tin}, {{0, 5}, {10, 5}})), "0,5:0 5,5:5 10,5:5");
}

TEST(Section, ASurfaceBeginsAndEndsWithTwoRows) {
  const Tin tin{{{0, 0, 1}, {10, 0, 1}, {10, 10, 1}, {0, 10, 1}}, {{0, 1, 2}, {0, 2, 3}}};
  EXPECT_EQ(written(section_of({tin}, {{-5, 2}, {15, 2}})), "-5,2:- 0,2:- 0,2:1 2,2:1 10,2:1 10,2:- 15,2:-");
}

TEST(Section, GapsBetweenTwoParts) {
  const Tin tin{{{0, 0, 1}, {1, 0, 1}, {1, 2, 1}, {0, 2, 1}, {3, 0, 2}, {4, 0, 2}, {4, 2, 2}, {3, 2, 2}},
                {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}}};
  const Section s = section_of({tin}, {{0, 1}, {4, 1}});
  EXPECT_EQ(written(s), "0,1:1 0.5,1:1 1,1:1 1,1:- 3,1:- 3,1:2 3.5,1:2 4,1:2");
}

TEST(Section, WallsGiveTwoRowsAtOnePlace) {
  const Tin tin{{{0, 0, 1}, {1, 0, 1}, {1, 2, 1}, {0, 2, 1}, {1, 0, 5}, {2, 0, 5}, {2, 2, 5}, {1, 2, 5}},
                {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}, {1, 4, 7}, {1, 7, 2}}};
  EXPECT_EQ(written(section_of({tin}, {{0, 1}, {2, 1}})), "0,1:1 0.5,1:1 1,1:1 1,1:5 1.5,1:5 2,1:5");
  // On the wall's foot: the upper side, whichever way.
  EXPECT_EQ(written(section_of({tin}, {{1, 0}, {1, 2}})), "1,0:5 1,2:5");
  EXPECT_EQ(written(section_of({tin}, {{1, 2}, {1, 0}})), "1,2:5 1,0:5");
}

TEST(Section, TheLineMayRunAlongEdgesAndThroughVertices) {
  const Tin tin = tin_of(ascii_raster({"012", "345", "678"}));
  const Box box = bounds(tin);
  const double y = (box.ymin + box.ymax) / 2;
  const Section along = section_of({tin}, {{box.xmin, y}, {box.xmax, y}});
  ASSERT_EQ(along.rows.size(), 3u);
  EXPECT_EQ(along.z, (std::vector<double>{3, 4, 5}));
  const Section diagonal = section_of({tin}, {{box.xmin, box.ymin}, {box.xmax, box.ymax}});
  EXPECT_EQ(diagonal.z.front(), 6);
  EXPECT_EQ(diagonal.z.back(), 2);
}

TEST(Section, TouchingACornerIsNotThere) {
  const Tin tin{{{0, 0, 1}, {2, 0, 1}, {1, 1, 1}}, {{0, 1, 2}}};
  EXPECT_EQ(written(section_of({tin}, {{0, 1}, {2, 1}})), "0,1:- 2,1:-");
}

TEST(Section, CornersOfTheLineAreStationsOnce) {
  const Tin tin{{{0, 0, 0}, {10, 0, 10}, {10, 10, 10}, {0, 10, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  EXPECT_EQ(written(section_of({tin}, {{2, 1}, {8, 1}, {8, 4}})), "2,1:2 8,1:8 8,4:8");
}

TEST(Section, SurfacesShareTheStations) {
  const Tin low{{{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const Tin high{{{5, 0, 5}, {15, 0, 15}, {15, 10, 15}, {5, 10, 5}}, {{0, 1, 2}, {0, 2, 3}}};
  EXPECT_EQ(written(section_of({low, high}, {{0, 2}, {12, 2}})),
            "0,2:0/- 2,2:0/- 5,2:0/- 5,2:0/5 7,2:0/7 10,2:0/10 10,2:-/10 12,2:-/12");
}

TEST(Section, RandomLinesLieOnTheSurface) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 40; ++round) {
    const Tin tin = random_tin(random, 24);
    const FaceGrid grid(tin);
    const Box box = bounds(tin);
    std::uniform_real_distribution<double> x(box.xmin - 3, box.xmax + 3), y(box.ymin - 3, box.ymax + 3);
    std::vector<Point2> line;
    for (int k = 0; k < 5; ++k) line.push_back({x(random), y(random)});
    const std::vector<const FaceGrid*> one = {&grid};
    Context context;
    const Section s = section(line, one, context);
    for (std::size_t k = 0; k + 1 < s.rows.size(); ++k) {
      if (s.rows[k].segment != s.rows[k + 1].segment || s.rows[k + 1].along - s.rows[k].along < 1e-9) continue;
      // Halfway between two stations the height is the mean, or there is none.
      const Point2 p = s.rows[k].at, q = s.rows[k + 1].at;
      const auto z = grid.height({(p.x + q.x) / 2, (p.y + q.y) / 2});
      ASSERT_EQ(z.has_value(), !std::isnan(s.z[k]) && !std::isnan(s.z[k + 1])) << round << " row " << k;
      if (z) {
        ASSERT_NEAR(*z, (s.z[k] + s.z[k + 1]) / 2, 1e-7);
      }
    }
  }
}

TEST(Section, BackwardsIsTheSame) {
  std::mt19937_64 random(8);
  const Tin tin = random_tin(random, 20);
  const Box box = bounds(tin);
  const Point2 a{box.xmin + 0.3, box.ymin + 0.2}, b{box.xmax - 1.7, box.ymax - 0.9};
  const Section there = section_of({tin}, {a, b}), back = section_of({tin}, {b, a});
  ASSERT_EQ(there.rows.size(), back.rows.size());
  for (std::size_t k = 0; k < there.rows.size(); ++k) {
    const double z = there.z[k], w = back.z[back.z.size() - 1 - k];
    ASSERT_EQ(std::isnan(z), std::isnan(w));
    if (!std::isnan(z)) {
      ASSERT_NEAR(z, w, 1e-9);
    }
  }
}

TEST(FaceGrid, HeightsAreThePlanesAndVerticesTheirOwn) {
  std::mt19937_64 random(9);
  const Tin tin = random_tin(random, 30);
  const FaceGrid grid(tin);
  std::vector<bool> used(tin.vertices.size());
  for (const Face& f : tin.faces)
    for (const Index v : f) used[v] = true;
  for (std::size_t v = 0; v < tin.vertices.size(); ++v)
    if (used[v]) {
      ASSERT_EQ(grid.height(plan(tin.vertices[v])), tin.vertices[v].z);
    }
  for (const Face& f : tin.faces) {
    const Point &a = tin.vertices[f[0]], &b = tin.vertices[f[1]], &c = tin.vertices[f[2]];
    const auto z = grid.height({(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3});
    ASSERT_TRUE(z);
    ASSERT_NEAR(*z, (a.z + b.z + c.z) / 3, 1e-7);
  }
}

TEST(FaceGrid, TheUpperAtAWallNoneOutside) {
  const Tin tin{{{0, 0, 1}, {1, 0, 1}, {1, 2, 1}, {0, 2, 1}, {1, 0, 5}, {2, 0, 5}, {2, 2, 5}, {1, 2, 5}},
                {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}, {1, 4, 7}, {1, 7, 2}}};
  const FaceGrid grid(tin);
  EXPECT_EQ(grid.height({1, 1}), 5);
  EXPECT_EQ(grid.height({2, 2}), 5);
  EXPECT_FALSE(grid.height({2.0000001, 1}));
  EXPECT_FALSE(FaceGrid(Tin{}).height({0, 0}));
}

TEST(FaceGrid, ThinFacesAcrossTheWholeGrid) {
  // A fan of slivers from one corner.
  Tin tin;
  tin.vertices.push_back({0, 0, 0});
  for (int k = 0; k <= 3000; ++k) tin.vertices.push_back({1000.0, k / 3.0, k / 3.0});
  for (Index k = 1; k <= 3000; ++k) tin.faces.push_back({0, k, k + 1});
  const FaceGrid grid(tin);
  for (const double t : {0.01, 0.3, 0.9})
    for (const double y : {1.0, 333.1, 777.7, 1000.0}) {
      const auto z = grid.height({1000 * t, y * t});
      ASSERT_TRUE(z);
      EXPECT_NEAR(*z, y * t, 1e-9);
    }
  const Section s = section_of({tin}, {{900, -1}, {900, 901}});
  EXPECT_EQ(s.rows.size(), 3001u + 4);
}

TEST(Section, LargeSurfacesTakeAMoment) {
  // Half a million faces on z = x + 2 y; whole numbers, so that the line meets a vertex every so often.
  Raster dem;
  dem.width = dem.height = 501;
  dem.dx = dem.dy = 1;
  dem.y0 = 500;
  for (int j = 0; j < 501; ++j)
    for (int i = 0; i < 501; ++i) dem.samples.push_back(i + 2.0 * (500 - j));
  const Tin tin = tin_of(dem);
  const Section s = section_of({tin}, {{-10, 100}, {510, 360}, {250, -5}});
  EXPECT_GT(s.rows.size(), 1500u);
  for (std::size_t k = 0; k < s.rows.size(); ++k)
    if (!std::isnan(s.z[k])) {
      ASSERT_NEAR(s.z[k], s.rows[k].at.x + 2 * s.rows[k].at.y, 1e-9);
    }
  const FaceGrid grid(tin);
  double sum = 0;
  for (int k = 0; k < 1'000'000; ++k) sum += grid.height({(k % 997) * 0.5, (k % 991) * 0.5}).value_or(-1e9);
  EXPECT_GT(sum, 0);
}
