// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/surface_distance.hpp"

#include <gmpxx.h>

#include <vector>

#include "support/plan_mesh.hpp"

namespace terrane::support {
namespace {

struct Place {
  mpq_class x, y;
};

mpq_class area2(const Place& a, const Place& b, const Place& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

using Corners = std::vector<Place>;

Corners corners(const Tin& tin, Index f) {
  Corners made;
  for (const Index v : tin.faces[f]) made.push_back({tin.vertices[v].x, tin.vertices[v].y});
  return made;
}

/// What of a convex polygon lies on the left of a line.
Corners clipped(const Corners& polygon, const Place& a, const Place& b) {
  Corners kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Place &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const mpq_class at_p = area2(a, b, p), at_q = area2(a, b, q);
    if (sgn(at_p) >= 0) kept.push_back(p);
    if (sgn(at_p) * sgn(at_q) < 0) {
      const mpq_class t = at_p / (at_p - at_q);
      kept.push_back({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
    }
  }
  return kept;
}

mpq_class height(const Tin& tin, Index f, const Corners& c, const Place& p) {
  mpq_class sum = 0;
  for (int k = 0; k < 3; ++k) sum += area2(c[(k + 1) % 3], c[(k + 2) % 3], p) * tin.vertices[tin.faces[f][k]].z;
  return sum / area2(c[0], c[1], c[2]);
}

}  // namespace

SurfaceDistance surface_distance(const Tin& a, const Tin& b) {
  std::vector<Corners> faces;
  std::vector<Box> boxes;
  for (Index g = 0; g < static_cast<Index>(b.faces.size()); ++g) {
    faces.push_back(corners(b, g));
    boxes.push_back(box_of(triangle(b, g)));
  }
  mpq_class largest = 0, shared2 = 0;
  for (Index f = 0; f < static_cast<Index>(a.faces.size()); ++f) {
    if (is_wall(a, a.faces[f])) continue;
    const Corners of_a = corners(a, f);
    const Box box = box_of(triangle(a, f));
    for (Index g = 0; g < static_cast<Index>(b.faces.size()); ++g) {
      if (!boxes_meet(box, boxes[g]) || is_wall(b, b.faces[g])) continue;
      Corners both = of_a;
      for (int k = 0; k < 3 && both.size() > 2; ++k) both = clipped(both, faces[g][k], faces[g][(k + 1) % 3]);
      mpq_class area = 0;
      for (std::size_t i = 2; i < both.size(); ++i) area += area2(both[0], both[i - 1], both[i]);
      if (sgn(area) <= 0) continue;
      shared2 += area;
      for (const Place& p : both) {
        const mpq_class d = abs(height(a, f, of_a, p) - height(b, g, faces[g], p));
        if (d > largest) largest = d;
      }
    }
  }
  return {largest.get_d(), shared2.get_d() / 2};
}

}  // namespace terrane::support
