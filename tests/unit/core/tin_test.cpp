// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tin.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>

using namespace terrane;

namespace {

/// A grid of n x n vertices with rough heights, as it comes.
Tin grid(int n, std::mt19937& random) {
  std::uniform_real_distribution<> jitter(-0.3, 0.3);
  Tin tin;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i)
      tin.vertices.push_back({5e5 + i + jitter(random), 5e6 + j + jitter(random), jitter(random)});
  }
  for (int j = 0; j + 1 < n; ++j) {
    for (int i = 0; i + 1 < n; ++i) {
      const int v = j * n + i;
      tin.faces.push_back({v, v + 1, v + n + 1});
      tin.faces.push_back({v, v + n + 1, v + n});
    }
  }
  return tin;
}

/// The same surface with vertices, faces and corners in another order, and some unused vertices.
Tin shuffled(const Tin& tin, std::mt19937& random) {
  std::vector<Index> place(tin.vertices.size() + 3);
  std::iota(place.begin(), place.end(), 0);
  std::shuffle(place.begin(), place.end(), random);
  Tin other;
  other.vertices.resize(place.size(), {1e9, -1e9, 0});
  for (std::size_t v = 0; v < tin.vertices.size(); ++v) other.vertices[place[v]] = tin.vertices[v];
  for (const Face& f : tin.faces) {
    const int k = static_cast<int>(random() % 3);
    other.faces.push_back({place[f[k]], place[f[(k + 1) % 3]], place[f[(k + 2) % 3]]});
  }
  std::shuffle(other.faces.begin(), other.faces.end(), random);
  return other;
}

bool same_bytes(const Tin& a, const Tin& b) {
  return a.faces == b.faces && a.vertices.size() == b.vertices.size() &&
         std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(Point)) == 0;
}

/// Coordinates of all faces, each turned to its smallest corner, sorted: the surface without any numbering.
std::vector<std::array<std::array<double, 3>, 3>> loose(const Tin& tin) {
  std::vector<std::array<std::array<double, 3>, 3>> faces;
  for (const Face& f : tin.faces) {
    std::array<std::array<double, 3>, 3> t;
    for (int k = 0; k < 3; ++k) t[k] = {tin.vertices[f[k]].x, tin.vertices[f[k]].y, tin.vertices[f[k]].z};
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    faces.push_back(t);
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

}  // namespace

TEST(Tin, BoundsOfAllVertices) {
  const Box box = bounds({{{1, 5, 0}, {-2, 7, 0}, {0, 6, 9}}, {}});
  EXPECT_EQ(box.xmin, -2);
  EXPECT_EQ(box.xmax, 1);
  EXPECT_EQ(box.ymin, 5);
  EXPECT_EQ(box.ymax, 7);
  EXPECT_GT(bounds({}).xmin, bounds({}).xmax);
}

TEST(Tin, CanonicalOrderDoesNotDependOnTheOrderGiven) {
  std::mt19937 random(1);
  for (int n : {2, 3, 10, 60}) {
    const Tin tin = grid(n, random), once = canonical(tin);
    EXPECT_EQ(loose(once), loose(tin));
    EXPECT_TRUE(same_bytes(canonical(once), once));
    for (int round = 0; round < 10; ++round) EXPECT_TRUE(same_bytes(canonical(shuffled(tin, random)), once));
  }
}

// What is in order already is given back as it is: nothing that is nearly so may be taken for it.
TEST(Tin, CanonicalPutsRightTheLeastThingOutOfOrder) {
  std::mt19937 random(6);
  Tin tin = grid(12, random);
  tin.vertices[5].z = tin.vertices[100].z = 0;
  tin.vertices.push_back(tin.vertices[143]);  // a wall's upper end at the place of its lower one
  tin.vertices.back().z += 1;
  tin.faces.push_back({143, 144, 142});
  const Tin once = canonical(tin);
  const auto swapped = [](Tin t, Index v, Index w) {
    std::swap(t.vertices[v], t.vertices[w]);
    for (Face& f : t.faces)
      for (Index& corner : f) corner = corner == v ? w : corner == w ? v : corner;
    return t;
  };
  for (Index v = 1; v < static_cast<Index>(once.vertices.size()); ++v) {
    Tin nearly = swapped(once, v - 1, v);
    EXPECT_TRUE(same_bytes(canonical(nearly), once));
    for (Face& f : nearly.faces) std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
    std::sort(nearly.faces.begin(), nearly.faces.end());  // only the vertices are out of order
    EXPECT_TRUE(same_bytes(canonical(nearly), once));
  }
  for (std::size_t f = 1; f < once.faces.size(); ++f) {
    Tin turned = once, exchanged = once;
    std::rotate(turned.faces[f].begin(), turned.faces[f].begin() + 1, turned.faces[f].end());
    std::swap(exchanged.faces[f - 1], exchanged.faces[f]);
    EXPECT_TRUE(same_bytes(canonical(turned), once));
    EXPECT_TRUE(same_bytes(canonical(exchanged), once));
  }
  Tin unused = once, negative = once, alike = once;
  unused.vertices.push_back(unused.vertices.back());
  unused.vertices.back().z += 1;
  EXPECT_TRUE(same_bytes(canonical(unused), once));
  for (Point& p : negative.vertices)
    if (p.z == 0) p.z = -0.0;
  EXPECT_TRUE(same_bytes(canonical(negative), once));
  alike.vertices.push_back(alike.vertices.back());
  for (Face& f : alike.faces)
    if (f[2] + 2 == static_cast<Index>(alike.vertices.size())) ++f[2];
  EXPECT_TRUE(same_bytes(canonical(alike), once));
}

TEST(Tin, CanonicalFacesStartLowAndAreSorted) {
  std::mt19937 random(2);
  const Tin tin = canonical(shuffled(grid(20, random), random));
  EXPECT_EQ(tin.vertices.size(), 400u);  // the unused ones are gone
  EXPECT_TRUE(std::is_sorted(tin.faces.begin(), tin.faces.end()));
  for (const Face& f : tin.faces) EXPECT_EQ(f[0], std::min({f[0], f[1], f[2]}));
}

TEST(Tin, CanonicalNeighboursAreNear) {
  std::mt19937 random(3);
  const Tin tin = canonical(grid(64, random));
  double path = 0;
  for (std::size_t v = 1; v < tin.vertices.size(); ++v) {
    path += std::hypot(tin.vertices[v].x - tin.vertices[v - 1].x, tin.vertices[v].y - tin.vertices[v - 1].y);
  }
  EXPECT_LT(path / tin.vertices.size(), 1.2);  // rows would be 1.06, a Z-curve 1.6, no order 33
}

TEST(Tin, CanonicalTellsCloseVerticesApart) {
  // Thousands of vertices in one cell of the curve's grid, and walls: two heights at one place.
  std::mt19937 random(4);
  Tin tin = grid(30, random);
  for (Point& p : tin.vertices) p = {1 + (p.x - 5e5) * 1e-15, 1 + (p.y - 5e6) * 1e-15, p.z};
  tin.vertices.push_back({1e12, 1e12, 0});
  tin.vertices.push_back({1e12, 1e12, 1});
  tin.vertices.push_back({1e12, 0, 0});
  tin.faces.push_back({900, 901, 902});
  const Tin once = canonical(tin);
  for (int round = 0; round < 10; ++round) EXPECT_TRUE(same_bytes(canonical(shuffled(tin, random)), once));
}

TEST(Tin, CanonicalJoinsVerticesAlikeInAllCoordinates) {
  std::mt19937 random(5);
  // Triangle soup, with both zeros.
  Tin soup;
  const Tin tin = grid(8, random);
  for (const Face& f : tin.faces) {
    for (int k = 0; k < 3; ++k) {
      Point p = tin.vertices[f[k]];
      if (f[k] == 0) p = {0.0, random() % 2 ? -0.0 : 0.0, random() % 2 ? -0.0 : 0.0};
      soup.vertices.push_back(p);
    }
    const Index n = static_cast<Index>(soup.vertices.size());
    soup.faces.push_back({n - 3, n - 2, n - 1});
  }
  const Tin once = canonical(soup);
  EXPECT_EQ(once.vertices.size(), 64u);
  for (int round = 0; round < 10; ++round) EXPECT_TRUE(same_bytes(canonical(shuffled(soup, random)), once));
}

TEST(Tin, CanonicalBearsAnyNumber) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const Tin tin{{{nan, 0, 0}, {inf, -inf, nan}, {1e308, -1e308, 0}, {-1e308, 1e308, 5e-324}}, {{0, 1, 2}, {1, 3, 2}}};
  EXPECT_EQ(canonical(tin).vertices.size(), 4u);
  EXPECT_TRUE(canonical({}).vertices.empty());
  EXPECT_EQ(canonical({{{7, 7, 7}}, {{0, 0, 0}}}).faces.size(), 1u);
}
