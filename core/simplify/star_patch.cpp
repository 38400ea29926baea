// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/simplify/star_patch.hpp"

#include <algorithm>
#include <cmath>

#include "core/plan/region_fill.hpp"
#include "core/predicates.hpp"

namespace terrane {
namespace {

double squared(Point2 a, Point2 b) { return (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y); }

/// The sum of the cotangents of a triangle's angles, times four. Its sum over a triangulation is least for the Delaunay
/// one (Musin 1997).
double sharpness(Point2 a, Point2 b, Point2 c, double area2) {
  return (squared(a, b) + squared(b, c) + squared(c, a)) / area2;
}

bool covers(Point2 a, Point2 b, Point2 c, Point2 p) {
  return orientation(a, b, p) >= 0 && orientation(b, c, p) >= 0 && orientation(c, a, p) >= 0;
}

}  // namespace

double StarPatch::along(int i, int j, double limit) {
  Cell& edge = cell(i, j);
  if (edge.off < 0) edge.off = deviation_.along(ring[i], ring[j], limit);
  return edge.off;
}

bool StarPatch::triangle_allowed(int i, int m, int j, double limit) const {
  for (const Index v : covered)
    if (covers(places_[i], places_[m], places_[j], deviation_.place(v)) &&
        !(deviation_.at(v, ring[i], ring[m], ring[j]) <= limit))
      return false;
  return true;
}

/// A triangulation of a simple polygon's corners, whose triangles are all positive, covers it once: their winding
/// numbers add up to the polygon's. So no test of visibility is needed.
bool StarPatch::best_triangulation(double limit, bool checked) {
  const int n = static_cast<int>(ring.size());
  for (int i = 0; i + 1 < n; ++i) cell(i, i + 1).cost = 0;
  for (int length = 2; length < n; ++length)
    for (int i = 0, j = length; j < n; ++i, ++j) {
      double best = INFINITY;
      int apex = none;
      for (int m = i + 1; m < j; ++m) {
        const double parts = cell(i, m).cost + cell(m, j).cost;
        if (!(parts < best)) continue;
        const double area2 = area2_accurate(places_[i], places_[m], places_[j]);
        if (!(area2 > 0)) continue;
        const double cost = parts + sharpness(places_[i], places_[m], places_[j], area2);
        if (!(cost < best) || (checked && !triangle_allowed(i, m, j, limit))) continue;
        best = cost, apex = m;
      }
      if (checked && apex != none && inner(i, j) && !(along(i, j, limit) <= limit)) best = INFINITY;
      cell(i, j).cost = best;
      cell(i, j).apex = apex;
    }
  triangles.clear();
  if (!(cell(0, n - 1).cost < INFINITY)) return false;
  collect(0, n - 1);
  return true;
}

void StarPatch::collect(int i, int j) {
  if (j - i < 2) return;
  const int m = cell(i, j).apex;
  triangles.push_back({i, m, j});
  collect(i, m);
  collect(m, j);
}

bool StarPatch::delaunay_of_many() {
  const auto n = static_cast<Index>(ring.size());
  std::vector<BorderEdge> border;
  for (Index i = 0; i < n; ++i) border.push_back({i, (i + 1) % n, i});
  triangles.clear();
  const FilledRegion filled = fill_region(places_, border);
  if (!filled.sound) return false;
  for (const Face& f : filled.faces) triangles.push_back({f[0], f[1], f[2]});
  return static_cast<Index>(triangles.size()) == n - 2;
}

/// Of the triangles as they are; more than `limit` once one is.
double StarPatch::measured(double limit) {
  const int n = static_cast<int>(ring.size());
  double largest = 0;
  for (const auto& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const int i = t[k], j = t[(k + 1) % 3], low = std::min(i, j), high = std::max(i, j);
      // An inner edge once, from its left side; the border that closes an open ring has but one.
      if (!inner(low, high) || (i > j && !(low == 0 && high == n - 1))) continue;
      largest = std::max(largest, n > many ? deviation_.along(ring[i], ring[j], limit) : along(low, high, limit));
      if (!(largest <= limit)) return INFINITY;
    }
  }
  for (const Index v : covered) {
    const Point2 p = deviation_.place(v);
    const auto t = std::find_if(triangles.begin(), triangles.end(),
                                [&](const auto& t) { return covers(places_[t[0]], places_[t[1]], places_[t[2]], p); });
    if (t == triangles.end()) return INFINITY;
    largest = std::max(largest, deviation_.at(v, ring[(*t)[0]], ring[(*t)[1]], ring[(*t)[2]]));
    if (!(largest <= limit)) return INFINITY;
  }
  return largest;
}

double StarPatch::fill(double limit) {
  const int n = static_cast<int>(ring.size());
  if (n < 3) return INFINITY;
  places_.clear();
  for (const Index v : ring) places_.push_back(deviation_.place(v));
  if (n > many) return delaunay_of_many() ? measured(limit) : INFINITY;
  cells_.assign(ring.size() * ring.size(), {INFINITY, none, -1});
  if (!best_triangulation(limit, false)) return INFINITY;
  const double error = measured(limit);
  if (error <= limit || !(limit < INFINITY)) return error;
  return best_triangulation(limit, true) ? measured(limit) : INFINITY;
}

}  // namespace terrane
