// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/heights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/predicates.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

double fraction(Point2 a, Point2 b, Point2 p) {  // of p's projection along a -> b, by the longer coordinate
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double t = std::fabs(dx) >= std::fabs(dy) ? (p.x - a.x) / dx : (p.y - a.y) / dy;
  return std::clamp(t, 0.0, 1.0);
}

}  // namespace

Index SurfaceHeights::real_half(Index e) const {
  const Index h = mesh_.half[e], t = mesh_.twin[h];
  if (mesh_.real(h >> 2)) return h;
  return t != none && mesh_.real(t >> 2) ? t : none;
}

double SurfaceHeights::on_edge(Index h, Point2 p) const {
  const int k = h & 3, k1 = k == 2 ? 0 : k + 1;
  const Index f = h >> 2;
  return mix(z(f, k), z(f, k1), fraction(mesh_.at(mesh_.origin(h)), mesh_.at(mesh_.target(h)), p));
}

double SurfaceHeights::on_plane(Index face, Point2 p) const {
  const Index* corner = &mesh_.corner[4 * face];
  return height_on_triangle({mesh_.at(corner[0]), mesh_.at(corner[1]), mesh_.at(corner[2])},
                            {z(face, 0), z(face, 1), z(face, 2)}, p);
}

double SurfaceHeights::at_vertex(Index vertex) const {
  constexpr double outside = std::numeric_limits<double>::quiet_NaN();
  if (vertex >= arrangement_.first_crossing()) {
    const Index h = real_half(arrangement_.crossing(vertex).edge[m_]);
    return h == none ? outside : on_edge(h, points_[vertex]);
  }
  const auto own = [&](Index place) {
    return mesh_.any_vertex[place] == none ? outside : tin_.vertices[mesh_.any_vertex[place]].z;
  };
  if (arrangement_.is_place_of(m_, vertex)) return own(arrangement_.place(m_, vertex));
  const Location& where = arrangement_.location(1 - m_, arrangement_.place(1 - m_, vertex));
  switch (where.kind) {
    case Location::place:
      return own(where.index);
    case Location::edge: {
      const Index h = real_half(mesh_.edge[where.index]);
      return h == none ? outside : on_edge(h, points_[vertex]);
    }
    case Location::face:
      break;
  }
  return mesh_.real(where.index) ? on_plane(where.index, points_[vertex]) : outside;
}

double SurfaceHeights::in_face(Index face, Index vertex) const {
  const auto edge_of_face = [&](Index e) {
    for (int k = 0; k < 3; ++k)
      if (mesh_.edge[4 * face + k] == e) return 4 * face + k;
    return none;
  };
  Index place = none, edge = none;
  if (vertex >= arrangement_.first_crossing()) {
    edge = arrangement_.crossing(vertex).edge[m_];
  } else if (arrangement_.is_place_of(m_, vertex)) {
    place = arrangement_.place(m_, vertex);
  } else {
    const Location& where = arrangement_.location(1 - m_, arrangement_.place(1 - m_, vertex));
    if (where.kind == Location::place) place = where.index;
    if (where.kind == Location::edge) edge = mesh_.edge[where.index];
  }
  if (place != none)
    for (int k = 0; k < 3; ++k)
      if (mesh_.corner[4 * face + k] == place) return z(face, k);
  if (edge != none)
    if (const Index h = edge_of_face(edge); h != none) return on_edge(h, points_[vertex]);
  return on_plane(face, points_[vertex]);
}

double SurfaceHeights::distance(Index face, Point2 p) const {
  double best = std::numeric_limits<double>::infinity();
  bool inside = true;
  for (int k = 0; k < 3; ++k) {
    const Point2 a = mesh_.at(mesh_.corner[4 * face + k]), b = mesh_.at(mesh_.corner[4 * face + (k + 1) % 3]);
    inside = inside && orientation(a, b, p) >= 0;
    double d;
    nearest_on_segment(a, b, p, d);
    best = std::min(best, d);
  }
  return inside ? 0 : best;
}

}  // namespace terrane
