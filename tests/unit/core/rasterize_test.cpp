// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rasterize.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>

#include "core/error.hpp"
#include "core/predicates.hpp"
#include "tests/support/lattice_checks.hpp"

using namespace terrane;
using namespace terrane::testing;

namespace {

Raster lattice(int width, int height, double x0, double y0, double dx, double dy) {
  return {width, height, x0, y0, dx, dy, {}};
}

Raster rasterized(const Tin& tin, const Raster& places, int threads = 1) {
  Context context;
  context.threads = threads;
  return rasterize(tin, places, context);
}

/// What the contract says, sample by sample and face by face; NaN where no face holds the place.
double truth(const Tin& tin, Point2 p) {
  double highest = NAN;
  for (const Face& f : tin.faces) {
    const Point &a = tin.vertices[f[0]], &b = tin.vertices[f[1]], &c = tin.vertices[f[2]];
    const int turn = orientation(plan(a), plan(b), plan(c));
    if (turn == 0) continue;
    if (orientation(plan(a), plan(b), p) * turn < 0 || orientation(plan(b), plan(c), p) * turn < 0 ||
        orientation(plan(c), plan(a), p) * turn < 0) {
      continue;
    }
    const long double wa = area2_accurate(plan(b), plan(c), p), wb = area2_accurate(plan(c), plan(a), p),
                      wc = area2_accurate(plan(a), plan(b), p);
    const double z = static_cast<double>((wa * a.z + wb * b.z + wc * c.z) / (wa + wb + wc));
    if (!(highest >= z)) highest = z;
  }
  return highest;
}

void expect_truth(const Tin& tin, const Raster& places) {
  const Raster got = rasterized(tin, places);
  double largest = 0;
  for (const Point& p : tin.vertices) largest = std::max(largest, std::fabs(p.z));
  for (int j = 0; j < got.height; ++j) {
    for (int i = 0; i < got.width; ++i) {
      const double expected = truth(tin, places.place(i, j)), z = got.at(i, j);
      ASSERT_EQ(std::isnan(z), std::isnan(expected)) << "sample " << i << ", " << j;
      if (std::isnan(z)) continue;
      ASSERT_NEAR(z, expected, 2e-13 * largest) << "sample " << i << ", " << j;
    }
  }
  for (const Face& f : tin.faces) {
    if (orientation(plan(tin.vertices[f[0]]), plan(tin.vertices[f[1]]), plan(tin.vertices[f[2]])) == 0) continue;
    for (const Index v : f) {
      for (int k = 0; k < got.width * got.height; ++k) {
        const int i = k % got.width, j = k / got.width;
        if (places.place(i, j) != plan(tin.vertices[v])) continue;
        EXPECT_GE(got.at(i, j), tin.vertices[v].z);
      }
    }
  }
}

/// Points on a small grid, so that sample lines run through vertices and along edges, in triangles of any shape.
Tin random_triangles(std::mt19937& random, int count, double x0, double y0, double cell) {
  const auto below = [&](int n) { return std::uniform_int_distribution<>(0, n - 1)(random); };
  Tin tin;
  for (int k = 0; k < count; ++k) {
    for (int corner = 0; corner < 3; ++corner) {
      tin.faces.resize(k + 1);
      tin.faces[k][corner] = static_cast<Index>(tin.vertices.size());
      const double nudge = below(4) == 0 ? std::ldexp(below(1000) - 500, -50) * (std::fabs(x0) + 1) : 0;
      tin.vertices.push_back(
          {x0 + (below(25) - 2) * cell / 2 + nudge, y0 - (below(25) - 2) * cell / 2, below(100) - 50.0});
    }
  }
  return tin;
}

}  // namespace

TEST(Rasterize, HoldsExactlyTheSamplesOfEachFace) {
  std::mt19937 random(1);
  for (int round = 0; round < 3000; ++round) {
    const double x0 = round % 3 == 0 ? 0 : round % 3 == 1 ? 500005 : -71.5 - 1.0 / 2400;
    const double y0 = round % 3 == 2 ? 44.9 : 4e6, cell = round % 3 == 2 ? 1.0 / 1200 : 10;
    expect_truth(random_triangles(random, 1 + round % 3, x0, y0, cell), lattice(11, 10, x0, y0, cell, cell));
    ASSERT_FALSE(HasFailure()) << "round " << round;
  }
}

TEST(Rasterize, HoldsThemAcrossTiles) {
  std::mt19937 random(4);
  for (int round = 0; round < 40; ++round) {
    const double x0 = round % 2 ? 500000.5 : -71.5 - 1.0 / 2400, y0 = round % 2 ? 4e6 : 44.9;
    const double cell = round % 2 ? 1 : 1.0 / 1200;
    expect_truth(random_triangles(random, 3, x0, y0, 25 * cell), lattice(283, 150, x0, y0, cell, cell));
    ASSERT_FALSE(HasFailure()) << "round " << round;
  }
}

/// Its area is below the noise of plain arithmetic, and a sample lies on its longest side.
TEST(Rasterize, HoldsTheSamplesOfALevelSliver) {
  std::mt19937 random(5);
  std::uniform_real_distribution<> unit(0.25, 0.75);
  int slivers = 0;
  while (slivers < 50) {
    const Point2 c{unit(random), unit(random)};
    const double k = unit(random);
    const Tin tin{{{-c.x, -c.y, 7}, {k * c.x, k * c.y, 7}, {c.x, c.y, 7}}, {{0, 1, 2}}};
    const Point &a = tin.vertices[0], &b = tin.vertices[1];
    const double d = (b.x - a.x) * (2 * c.y) - (b.y - a.y) * (2 * c.x);
    if (d != 0 || orientation(plan(a), plan(b), c) == 0) continue;
    ++slivers;
    expect_truth(tin, lattice(3, 3, -1, 1, 1, 1));
  }
}

TEST(Rasterize, GivesBackTheSamplesOfARaster) {
  std::mt19937 random(2);
  for (const double voids : {0.0, 0.1}) {
    Raster dem = random_raster(random, 90, 150, voids, 400);
    dem.x0 = -71.5 - 1.0 / 2400, dem.y0 = 44.9, dem.dx = dem.dy = 1.0 / 1200;
    const Triangulated t = run(dem, 0);
    const Raster back = rasterized(t.tin, dem);
    std::size_t there = 0;
    for (std::size_t k = 0; k < dem.samples.size(); ++k) {
      if (std::isnan(back.samples[k])) continue;
      EXPECT_EQ(back.samples[k], dem.samples[k]);
      ++there;
    }
    EXPECT_EQ(there, t.tin.vertices.size());
    // And within the bound those of a coarser TIN.
    const Raster near = rasterized(run(dem, 20).tin, dem);
    for (std::size_t k = 0; k < dem.samples.size(); ++k) {
      if (std::isnan(near.samples[k])) continue;
      EXPECT_NEAR(near.samples[k], dem.samples[k], 20 * (1 + 1e-12));
    }
  }
}

TEST(Rasterize, TakesTheUpperFaceAtAWall) {
  // A step along x = 1, from 0 to 5, with the wall between.
  const Tin tin{{{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}, {1, 0, 5}, {2, 0, 5}, {2, 2, 5}, {1, 2, 5}},
                {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}, {1, 4, 7}, {1, 7, 2}}};
  const Raster got = rasterized(tin, lattice(5, 3, 0, 2, 0.5, 1));
  for (int j = 0; j < 3; ++j) {
    EXPECT_EQ(got.at(1, j), 0);
    EXPECT_EQ(got.at(2, j), 5);
    EXPECT_EQ(got.at(3, j), 5);
  }
}

TEST(Rasterize, TheSameBytesForAnyThreadsAndAnyOrder) {
  std::mt19937 random(3);
  const Raster dem = random_raster(random, 200, 300, 0.01, 40);
  Tin tin = run(dem, 1).tin;
  // Walls, and zeros of both signs where they stand.
  for (Point& p : tin.vertices) p.z = p.x < 100 ? p.z : p.y < 150 ? 0.0 : -0.0;
  const Tin above = tin;
  for (Point p : above.vertices) tin.vertices.push_back({p.x, p.y, -p.z});
  for (const Face& f : above.faces) {
    const Index n = static_cast<Index>(above.vertices.size());
    tin.faces.push_back({f[0] + n, f[1] + n, f[2] + n});
  }
  const auto same = [](const Raster& a, const Raster& b) {
    return std::equal(a.samples.begin(), a.samples.end(), b.samples.begin(), b.samples.end(), [](double x, double y) {
      return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
    });
  };
  for (const Raster& places : {lattice(333, 777, -3.3, 301.7, 0.61, 0.39), lattice(200, 300, dem.x0, dem.y0, 1, 1)}) {
    Tin shuffled = tin;
    const Raster one = rasterized(tin, places);
    for (const int threads : {2, 3, 7}) EXPECT_TRUE(same(one, rasterized(tin, places, threads)));
    std::shuffle(shuffled.faces.begin(), shuffled.faces.end(), random);
    for (Face& f : shuffled.faces) std::rotate(f.begin(), f.begin() + random() % 3, f.end());
    EXPECT_TRUE(same(one, rasterized(shuffled, places, 2)));
  }
}

TEST(Rasterize, RefusesCellsThatNumbersCannotHold) {
  const Tin tin{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  EXPECT_THROW(rasterized(tin, lattice(10, 1, -1e308, 1e308, INFINITY, INFINITY)), Error);
  EXPECT_THROW(rasterized(tin, lattice(1, 5, 1e16, 0, 0.5, 0.5)), Error);
}

TEST(Rasterize, NothingOfNothing) {
  EXPECT_EQ(rasterized({}, lattice(3, 2, 0, 0, 1, 1)).samples.size(), 6u);
  EXPECT_TRUE(std::isnan(rasterized({}, lattice(3, 2, 0, 0, 1, 1)).at(2, 1)));
  EXPECT_TRUE(rasterized({}, lattice(0, 0, 0, 0, 1, 1)).samples.empty());
  EXPECT_THROW(rasterized({}, lattice(3, 3, 1e18, 0, 1, 1)), Error);
}
