// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "core/triangulate.hpp"

// What triangulations of rasters are held against, in integers.
namespace terrane::testing {

using Place = std::array<std::int64_t, 2>;  // column, and row counted from the south
using Step = std::array<Place, 2>;
constexpr double nan_height = std::numeric_limits<double>::quiet_NaN();

inline double height_at(const Raster& dem, Place p) {
  return dem.at(static_cast<int>(p[0]), static_cast<int>(dem.height - 1 - p[1]));
}

inline std::int64_t turn(Place a, Place b, Place c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// What the contract says the domain is: triangles of lattice places, counter-clockwise.
inline std::vector<std::array<Place, 3>> domain_triangles(const Raster& dem) {
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
inline std::set<Step> border_steps(const std::vector<std::array<Place, 3>>& triangles) {
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
inline void expect_correct(const Raster& dem, const Triangulated& result, double max_error) {
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

inline void expect_delaunay(const Raster& dem, const Tin& tin) {
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

inline Triangulated run(const Raster& dem, double max_error, std::size_t max_triangles = 0) {
  Context context;
  return triangulate(dem, {max_error, max_triangles}, context);
}

inline Raster random_raster(std::mt19937& random, int width, int height, double void_share, int range) {
  Raster dem{width, height, 0, height - 1.0, 1, 1, {}};
  const double slope = std::uniform_real_distribution<>(-2, 2)(random);
  for (int i = 0; i < width * height; ++i) {
    const bool gone = std::uniform_real_distribution<>()(random) < void_share;
    const double z = std::uniform_int_distribution<>(0, range)(random) + std::round(slope * (i % width));
    dem.samples.push_back(gone ? nan_height : z / 4);
  }
  return dem;
}

inline Raster window(const Raster& whole, int i0, int j0, int i1, int j1) {
  Raster part{i1 - i0, j1 - j0, whole.place(i0, 0).x, whole.place(0, j0).y, whole.dx, whole.dy, {}};
  for (int j = j0; j < j1; ++j) {
    for (int i = i0; i < i1; ++i) part.samples.push_back(whole.at(i, j));
  }
  return part;
}

}  // namespace terrane::testing
