// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/triangulate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/error.hpp"
#include "tests/support/ascii_raster.hpp"
#include "tests/support/lattice_checks.hpp"

using namespace terrane;
using namespace terrane::testing;

TEST(Triangulate, EverySampleIsAVertex) {
  const Raster dem = ascii_raster({"012", "345", "678"});
  const Triangulated t = run(dem, 0);
  EXPECT_EQ(t.tin.vertices.size(), 9u);
  EXPECT_EQ(t.tin.faces.size(), 8u);
  EXPECT_EQ(t.error, 0);
  expect_correct(dem, t, 0);
}

TEST(Triangulate, DiagonalHasTheSmallerHeightDifference) {
  const auto has_edge = [](const Tin& tin, Point2 a, Point2 b) {
    return std::any_of(tin.faces.begin(), tin.faces.end(), [&](const Face& f) {
      int ends = 0;
      for (const Index v : f) ends += plan(tin.vertices[v]) == a || plan(tin.vertices[v]) == b;
      return ends == 2;
    });
  };
  // |ll - ur| = 1 < |lr - ul| = 5: rising to the right.
  EXPECT_TRUE(has_edge(run(ascii_raster({"03", "25"}), 0).tin, {0, 0}, {1, 1}));
  // |ll - ur| = 5 > |lr - ul| = 1: falling to the right.
  EXPECT_TRUE(has_edge(run(ascii_raster({"15", "02"}), 0).tin, {0, 1}, {1, 0}));
  // A tie: lower-left to upper-right.
  EXPECT_TRUE(has_edge(run(ascii_raster({"00", "00"}), 0).tin, {0, 0}, {1, 1}));
  EXPECT_TRUE(has_edge(run(ascii_raster({"23", "14"}), 0).tin, {0, 0}, {1, 1}));
}

TEST(Triangulate, CellsWithOneVoidCornerAreClosedByTheirTriangle) {
  for (const Raster& dem : {ascii_raster({".1", "23"}), ascii_raster({"1.", "23"}), ascii_raster({"12", ".3"}),
                            ascii_raster({"12", "3."})}) {
    for (const double bound : {0.0, 1.0}) {
      const Triangulated t = run(dem, bound);
      ASSERT_EQ(t.tin.faces.size(), 1u);
      expect_correct(dem, t, bound);
    }
  }
}

TEST(Triangulate, NothingWhereThereIsNoCell) {
  for (const Raster& dem : {ascii_raster({"123"}), ascii_raster({"1", "2"}), ascii_raster({"..", ".."}),
                            ascii_raster({"1.1", ".1.", "1.1"}), ascii_raster({"1.", ".1"})}) {
    for (const double bound : {0.0, 1.0}) {
      const Triangulated t = run(dem, bound);
      EXPECT_TRUE(t.tin.vertices.empty());
      EXPECT_TRUE(t.tin.faces.empty());
    }
  }
}

TEST(Triangulate, HolesIslandsCorridorsAndTouchingParts) {
  for (const Raster& dem : {
           ascii_raster({"000000000", "0.......0", "0.11111.0", "0.1...1.0", "0.1.9.1.0", "0.1...1.0", "0.11111.0",
                         "0.......0", "000000000"}),
           ascii_raster({"0000000", "0000000", "00...00", "00.9.00", "00...00", "0000000", "0000000"}),
           ascii_raster({"99.....", "99.....", "..55...", "..55...", "....11.", "....11.", "......."}),
           ascii_raster({"990000", "990000", "005500", "005500"}),
           ascii_raster({"1111....", "1111....", "1111....", "..11....", "..112222", "....2222", "....2222"}),
           ascii_raster({"111.", "11.2", "1.22", ".222"}),
           ascii_raster({"....5....", "...555...", "..55555..", ".5555555.", "..55555..", "...555...", "....5...."}),
           ascii_raster({"9.9.9", "99999", "9.9.9", "99999", "9.9.9"}),
           ascii_raster({"3333333333333333", "3..............3", "3333333333333333"}),
       }) {
    for (const double bound : {0.0, 0.25, 1.0, 100.0}) {
      const Triangulated t = run(dem, bound);
      expect_correct(dem, t, bound);
      if (bound > 0) expect_delaunay(dem, t.tin);
    }
  }
}

TEST(Triangulate, AFlatRasterIsTwoTriangles) {
  const Triangulated t = run(Raster{50, 70, 10, 20, 2, 3, Array<double>(3500, 7.0)}, 0.01);
  EXPECT_EQ(t.tin.faces.size(), 2u);
  EXPECT_EQ(t.error, 0);
}

TEST(Triangulate, APlaneIsTwoTriangles) {
  Raster dem{60, 40, 0, 39, 1, 1, {}};
  for (int j = 0; j < 40; ++j) {
    for (int i = 0; i < 60; ++i) dem.samples.push_back(2 * i - 3 * j);
  }
  EXPECT_EQ(run(dem, 0.01).tin.faces.size(), 2u);
}

TEST(Triangulate, RandomRastersHoldEveryPostCondition) {
  std::mt19937 random(1);
  for (int round = 0; round < 6000; ++round) {
    const auto below = [&](int n) { return std::uniform_int_distribution<>(0, n - 1)(random); };
    const double voids = std::array{0.0, 0.05, 0.2, 0.5}[below(4)];
    const Raster dem = random_raster(random, 2 + below(12), 2 + below(12), voids, std::array{1, 3, 40}[below(3)]);
    const double bound = std::array{0.0, 0.25, 0.5, 1.0, 2.5, 5.0}[below(6)];
    const Triangulated t = run(dem, bound);
    expect_correct(dem, t, bound);
    if (bound > 0) expect_delaunay(dem, t.tin);
    if (HasFatalFailure() || HasNonfatalFailure()) {
      FAIL() << "round " << round << ", " << dem.width << " x " << dem.height << ", bound " << bound;
    }
  }
}

TEST(Triangulate, LargerRandomRastersHoldEveryPostCondition) {
  std::mt19937 random(2);
  for (int round = 0; round < 60; ++round) {
    const auto below = [&](int n) { return std::uniform_int_distribution<>(0, n - 1)(random); };
    Raster dem = random_raster(random, 20 + below(60), 20 + below(60), 0, 2);
    for (int hole = below(8); hole > 0; --hole) {  // runs long enough to be thinned
      const int i0 = below(dem.width), j0 = below(dem.height), i1 = i0 + below(25), j1 = j0 + below(25);
      for (int j = j0; j < std::min(j1, dem.height); ++j) {
        for (int i = i0; i < std::min(i1, dem.width); ++i)
          dem.samples[static_cast<std::size_t>(j) * dem.width + i] = nan_height;
      }
    }
    // A cell that is no round number of doubles, far from the origin.
    if (round % 2) dem.x0 = -71.5 - 1.0 / 2400, dem.y0 = 44.9, dem.dx = dem.dy = 1.0 / 1200;
    const double bound = std::array{0.25, 0.5, 1.0}[below(3)];
    const Triangulated t = run(dem, bound);
    expect_correct(dem, t, bound);
    expect_delaunay(dem, t.tin);
    ASSERT_FALSE(HasFailure()) << "round " << round;
  }
}

TEST(Triangulate, ALimitOfTrianglesIsKept) {
  std::mt19937 random(4);
  const Raster dem = random_raster(random, 60, 60, 0, 40);
  for (const double bound : {0.0, 0.25}) {
    std::vector<double> errors;
    for (const std::size_t limit : {2, 3, 10, 100, 1000, 5000}) {
      const Triangulated t = run(dem, bound, limit);
      EXPECT_LE(t.tin.faces.size(), limit);
      EXPECT_GE(t.tin.faces.size() + 1, limit);
      EXPECT_GT(t.error, bound);
      expect_correct(dem, t, t.error * (1 + 1e-12));
      errors.push_back(t.error);
    }
    EXPECT_LT(errors.back(), 0.5 * errors.front());
  }
  EXPECT_EQ(run(dem, 0, 100'000).error, 0);
}

TEST(Triangulate, BoundHoldsWhereDoublesAreCoarse) {
  std::mt19937 random(6);
  Raster dem = random_raster(random, 80, 80, 0, 4000);
  dem.x0 = 5e6 + 0.1;
  dem.y0 = 5e6 + 0.3;
  dem.dx = dem.dy = 0.001;
  const Triangulated t = run(dem, 100);
  EXPECT_LE(t.error, 100);
  expect_correct(dem, t,
                 100 + 1e-6);  // 1e-6: what the places' rounding (1e-6 of a
                               // cell) makes of slopes of 1000 per cell
}

TEST(Triangulate, RefusesWhatHasNoAnswer) {
  const auto code = [](const Raster& dem, double bound) {
    try {
      run(dem, bound);
    } catch (const Error& e) {
      EXPECT_EQ(e.kind, ErrorKind::input);
      return e.code;
    }
    return std::string();
  };
  Raster dem = ascii_raster({"12", "34"});
  dem.x0 = 1e18;
  EXPECT_EQ(code(dem, 1), "cell-size");
  dem = ascii_raster({"12", "34"});
  dem.samples[2] = INFINITY;
  EXPECT_EQ(code(dem, 1), "not-finite");
  EXPECT_EQ(code(dem, 0), "not-finite");
}

TEST(Triangulate, StopsWhenCancelled) {
  std::mt19937 random(7);
  const Raster dem = random_raster(random, 300, 300, 0, 40);
  Context context;
  int calls = 0;
  context.on_progress = [&](std::string_view, double fraction) {
    EXPECT_GE(fraction, 0);
    EXPECT_LE(fraction, 1);
    if (++calls == 5) context.cancelled = true;
  };
  EXPECT_THROW(triangulate(dem, {0.25, 0}, context), Error);
  EXPECT_EQ(calls, 5);
}
