// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/triangulate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "core/error.hpp"
#include "tests/support/ascii_raster.hpp"

using namespace terrane;
using terrane::testing::ascii_raster;

namespace {

using Place = std::array<std::int64_t, 2>;  // column, and row counted from the south
using Step = std::array<Place, 2>;
constexpr double nan_height = std::numeric_limits<double>::quiet_NaN();

double height_at(const Raster& dem, Place p) {
  return dem.at(static_cast<int>(p[0]), static_cast<int>(dem.height - 1 - p[1]));
}

std::int64_t turn(Place a, Place b, Place c) { return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]); }

/// What the contract says the domain is: triangles of lattice places, counter-clockwise.
std::vector<std::array<Place, 3>> domain_triangles(const Raster& dem) {
  std::vector<std::array<Place, 3>> triangles;
  for (std::int64_t y = 0; y + 1 < dem.height; ++y) {
    for (std::int64_t x = 0; x + 1 < dem.width; ++x) {
      std::vector<Place> ring;
      for (const Place p : {Place{x, y}, Place{x + 1, y}, Place{x + 1, y + 1}, Place{x, y + 1}}) {
        if (!std::isnan(height_at(dem, p))) ring.push_back(p);
      }
      if (ring.size() >= 3) triangles.push_back({ring[0], ring[1], ring[2]});
      if (ring.size() == 4) triangles.push_back({ring[0], ring[2], ring[3]});
    }
  }
  return triangles;
}

/// Boundary of a set of triangles as unit steps along the lattice, opposite ones cancelled.
std::set<Step> border_steps(const std::vector<std::array<Place, 3>>& triangles) {
  std::map<Step, int> count;
  for (const auto& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const Place a = t[k], b = t[(k + 1) % 3];
      if (count[{b, a}] > 0) {
        --count[{b, a}];
      } else {
        ++count[{a, b}];
      }
    }
  }
  std::set<Step> steps;
  for (const auto& [edge, n] : count) {
    if (n == 0) continue;
    EXPECT_EQ(n, 1);
    const Place a = edge[0], b = edge[1];
    const std::int64_t length = std::max(std::abs(b[0] - a[0]), std::abs(b[1] - a[1]));
    const std::int64_t dx = (b[0] - a[0]) / length, dy = (b[1] - a[1]) / length;
    EXPECT_TRUE(a[0] + length * dx == b[0] && a[1] + length * dy == b[1]) << "a border edge between lattice directions";
    for (std::int64_t k = 0; k < length; ++k) {
      steps.insert({Place{a[0] + k * dx, a[1] + k * dy}, Place{a[0] + (k + 1) * dx, a[1] + (k + 1) * dy}});
    }
  }
  return steps;
}

/// Every post-condition, in integers. Heights must be whole numbers times 1/4.
void expect_correct(const Raster& dem, const Triangulated& result, double max_error) {
  const Tin& tin = result.tin;
  std::vector<Place> places;
  std::set<Place> once;
  for (const Point& p : tin.vertices) {
    const Place place{std::llround((p.x - dem.x0) / dem.dx), dem.height - 1 - std::llround((dem.y0 - p.y) / dem.dy)};
    places.push_back(place);
    ASSERT_TRUE(once.insert(place).second) << "two vertices at one sample";
    ASSERT_EQ(p.x, dem.place(static_cast<int>(place[0]), 0).x);
    ASSERT_EQ(p.y, dem.place(0, static_cast<int>(dem.height - 1 - place[1])).y);
    ASSERT_EQ(p.z, height_at(dem, place));
  }
  std::vector<bool> used(places.size(), false);
  std::vector<std::array<Place, 3>> faces;
  double worst = 0;
  std::set<Place> covered;
  for (const Face& f : tin.faces) {
    const std::array<Place, 3> t{places[f[0]], places[f[1]], places[f[2]]};
    for (const Index v : f) used[v] = true;
    faces.push_back(t);
    const std::int64_t area = turn(t[0], t[1], t[2]);
    ASSERT_GT(area, 0);
    const auto [x0, x1] = std::minmax({t[0][0], t[1][0], t[2][0]});
    const auto [y0, y1] = std::minmax({t[0][1], t[1][1], t[2][1]});
    for (std::int64_t y = y0; y <= y1; ++y) {
      for (std::int64_t x = x0; x <= x1; ++x) {
        const Place p{x, y};
        const std::int64_t a = turn(t[1], t[2], p), b = turn(t[2], t[0], p), c = turn(t[0], t[1], p);
        if (a < 0 || b < 0 || c < 0) continue;
        covered.insert(p);
        if (once.count(p)) {
          ASSERT_TRUE(p == t[0] || p == t[1] || p == t[2]) << "a T-junction";
        }
        // Exact: quarters times small integers.
        const double error = std::fabs(a * height_at(dem, t[0]) + b * height_at(dem, t[1]) + c * height_at(dem, t[2]) -
                                       area * height_at(dem, p));
        ASSERT_LE(error, max_error * area);
        worst = std::max(worst, error / area);
      }
    }
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
  EXPECT_NEAR(result.error, worst, 1e-9 * (1 + worst));
  // Positive triangles whose boundary is the domain's cover the domain once and nothing else.
  const auto domain = domain_triangles(dem);
  EXPECT_EQ(border_steps(faces), border_steps(domain));
  std::int64_t area = 0;
  for (const auto& t : faces) area += turn(t[0], t[1], t[2]);
  EXPECT_EQ(area, static_cast<std::int64_t>(domain.size()));
  for (const auto& t : domain) {
    for (const Place p : t) ASSERT_TRUE(covered.count(p));
  }
}

void expect_delaunay(const Raster& dem, const Tin& tin) {
  std::map<std::array<Index, 2>, Index> apex;
  for (const Face& f : tin.faces) {
    for (int k = 0; k < 3; ++k) apex[{f[k], f[(k + 1) % 3]}] = f[(k + 2) % 3];
  }
  const auto at = [&](Index v) {
    return std::array{std::nearbyint((tin.vertices[v].x - dem.x0) / dem.dx),
                      std::nearbyint((tin.vertices[v].y - dem.y0) / dem.dy)};
  };
  for (const auto& [edge, c] : apex) {
    const auto other = apex.find({edge[1], edge[0]});
    if (other == apex.end()) continue;
    const auto d = at(other->second);
    std::array<std::array<double, 3>, 3> m;
    int row = 0;
    for (const Index v : {edge[0], edge[1], c}) {
      const double x = at(v)[0] - d[0], y = at(v)[1] - d[1];
      m[row++] = {x, y, x * x + y * y};
    }
    const double det = m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) +
                       m[1][2] * (m[2][0] * m[0][1] - m[2][1] * m[0][0]) +
                       m[2][2] * (m[0][0] * m[1][1] - m[0][1] * m[1][0]);
    ASSERT_LE(det, 0);
  }
}

Triangulated run(const Raster& dem, double max_error, std::size_t max_triangles = 0) {
  Context context;
  return triangulate(dem, {max_error, max_triangles}, context);
}

Raster random_raster(std::mt19937& random, int width, int height, double void_share, int range) {
  Raster dem{width, height, 0, height - 1.0, 1, 1, {}};
  const double slope = std::uniform_real_distribution<>(-2, 2)(random);
  for (int i = 0; i < width * height; ++i) {
    const bool gone = std::uniform_real_distribution<>()(random) < void_share;
    const double z = std::uniform_int_distribution<>(0, range)(random) + std::round(slope * (i % width));
    dem.samples.push_back(gone ? nan_height : z / 4);
  }
  return dem;
}

Raster window(const Raster& whole, int i0, int j0, int i1, int j1) {
  Raster part{i1 - i0, j1 - j0, whole.place(i0, 0).x, whole.place(0, j0).y, whole.dx, whole.dy, {}};
  for (int j = j0; j < j1; ++j) {
    for (int i = i0; i < i1; ++i) part.samples.push_back(whole.at(i, j));
  }
  return part;
}

std::set<double> heights_along(const Tin& tin, double x) {
  std::set<double> ys;
  for (const Point& p : tin.vertices) {
    if (p.x == x) ys.insert(p.y);
  }
  return ys;
}

}  // namespace

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
  const Triangulated t = run(Raster{50, 70, 10, 20, 2, 3, std::vector<double>(3500, 7.0)}, 0.01);
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

TEST(Triangulate, TilesWithASharedEdgeMeetVertexOnVertex) {
  std::mt19937 random(3);
  for (int round = 0; round < 50; ++round) {
    Raster whole = random_raster(random, 41, 60, 0, 12);
    for (const double bound : {0.25, 1.0, 2.0}) {
      const auto west = heights_along(run(window(whole, 0, 0, 21, 60), bound).tin, 20);
      const auto east = heights_along(run(window(whole, 20, 0, 41, 60), bound).tin, 20);
      ASSERT_EQ(west, east);
      EXPECT_LT(west.size(), bound < 2 ? 61u : 60u) << "the border is not thinned";
    }
    // A hole of the western tile that reaches up to the shared column: there the west has no border, beside it the same
    // one.
    for (int j = 20; j < 30; ++j) {
      for (int i = 15; i < 20; ++i) whole.samples[static_cast<std::size_t>(j) * 41 + i] = nan_height;
    }
    const auto west = heights_along(run(window(whole, 0, 0, 21, 60), 1).tin, 20);
    for (const double y : heights_along(run(window(whole, 20, 0, 41, 60), 1).tin, 20)) {
      const bool beside_hole = y > 59 - 29 && y < 59 - 20;
      EXPECT_EQ(west.count(y), beside_hole ? 0u : 1u);
    }
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

TEST(Triangulate, TheSameBytesEachTime) {
  std::mt19937 random(5);
  const Raster dem = random_raster(random, 100, 100, 0.01, 40);
  EXPECT_EQ(run(dem, 1).tin, run(dem, 1).tin);
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
                 100 + 1e-6);  // 1e-6: what the places' rounding (1e-6 of a cell) makes of slopes of 1000 per cell
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

TEST(Triangulate, RealTerrainWithinItsBoundAndItsTilesMeet) {
  std::ifstream file(TERRANE_SOURCE_DIR "/../shared/data/tiles/N44W072.hgt", std::ios::binary);
  if (!file) GTEST_SKIP() << "tiles/N44W072.hgt is not here";
  Raster tile{1201, 1201, -72, 45, 1.0 / 1200, 1.0 / 1200, {}};
  for (char bytes[2]; file.read(bytes, 2);) {
    tile.samples.push_back(
        static_cast<std::int16_t>(static_cast<unsigned char>(bytes[0]) << 8 | static_cast<unsigned char>(bytes[1])));
  }
  ASSERT_EQ(tile.samples.size(), 1201u * 1201u);
  const Raster whole = window(tile, 500, 700, 901, 1101);  // Mount Washington
  const Triangulated t = run(whole, 20);
  EXPECT_LE(t.error, 20);
  EXPECT_LT(t.tin.vertices.size(), 20'000u);
  expect_correct(whole, t, 20);
  const double x = whole.place(200, 0).x;
  const auto shared = heights_along(run(window(whole, 0, 0, 201, 401), 20).tin, x);
  EXPECT_EQ(shared, heights_along(run(window(whole, 200, 0, 401, 401), 20).tin, x));
  EXPECT_GT(shared.size(), 20u);
  EXPECT_LT(shared.size(), 300u);
}
