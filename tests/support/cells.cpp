// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/cells.hpp"

namespace terrane::support {
namespace {

template <class Number>
struct Spot {
  Number x, y;
};

template <class Number>
Number cross(const Spot<Number>& a, const Spot<Number>& b, const Spot<Number>& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

template <class Number>
using Polygon = std::vector<Spot<Number>>;

/// Places relative to an origin, so that long doubles hold the differences.
template <class Number>
Polygon<Number> moved(const Triangle& t, Point2 origin) {
  Polygon<Number> polygon;
  for (const Point2 p : t) polygon.push_back({Number(p.x) - Number(origin.x), Number(p.y) - Number(origin.y)});
  return polygon;
}

/// Sutherland & Hodgman (1974). A wrong sign of a distance near 0 costs an area near 0.
template <class Number>
Polygon<Number> clipped(Polygon<Number> polygon, const Polygon<Number>& by) {
  Polygon<Number> kept;
  for (std::size_t k = 0; k < by.size(); ++k) {
    kept.clear();
    const auto &p = by[k], &q = by[(k + 1) % by.size()];
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const auto &u = polygon[i], &v = polygon[(i + 1) % polygon.size()];
      const Number du = cross(p, q, u), dv = cross(p, q, v);
      if (du >= 0) kept.push_back(u);
      if ((du > 0 && dv < 0) || (du < 0 && dv > 0)) {
        const Number t = du / (du - dv);
        kept.push_back({Number(u.x + t * (v.x - u.x)), Number(u.y + t * (v.y - u.y))});
      }
    }
    std::swap(polygon, kept);
  }
  return polygon;
}

using Real = long double;

/// The height of a plane through three places.
Real height(const Polygon<Real>& t, const std::array<double, 3>& z, const Spot<Real>& p) {
  const Real u = cross(t[0], p, t[2]), v = cross(t[0], t[1], p), whole = cross(t[0], t[1], t[2]);
  return z[0] + (u * (Real(z[1]) - z[0]) + v * (Real(z[2]) - z[0])) / whole;
}

std::array<double, 3> heights(const Tin& tin, Index f) {
  const Face& t = tin.faces[f];
  return {tin.vertices[t[0]].z, tin.vertices[t[1]].z, tin.vertices[t[2]].z};
}

Cell measured(const Tin& a, const Tin& b, Index f, Index g) {
  const Triangle s = triangle(a, f), t = triangle(b, g);
  const Polygon<Real> at = moved<Real>(s, s[0]), bt = moved<Real>(t, s[0]), shared = clipped(at, bt);
  const auto za = heights(a, f), zb = heights(b, g);
  Real area = 0, perimeter = 0, volume = 0;
  std::vector<Real> dz;
  for (const auto& p : shared) dz.push_back(height(at, za, p) - height(bt, zb, p));
  for (std::size_t i = 0; i < shared.size(); ++i) {
    const std::size_t j = (i + 1) % shared.size();
    perimeter += length(shared[j].x - shared[i].x, shared[j].y - shared[i].y);
    if (i == 0 || j == 0) continue;
    const Real part = cross(shared[0], shared[i], shared[j]) / 2;
    area += part;
    volume += part * (dz[0] + dz[i] + dz[j]) / 3;
  }
  return {f, g, area, static_cast<double>(perimeter), static_cast<double>(volume)};
}

}  // namespace

std::vector<Cell> shared_cells(const Tin& a, const Tin& b) {
  std::vector<Cell> cells;
  std::vector<Triangle> triangles;
  std::vector<Box> boxes;
  std::vector<Index> faces;
  for (Index g = 0; g < static_cast<Index>(b.faces.size()); ++g) {
    if (is_wall(b, b.faces[g])) continue;
    triangles.push_back(triangle(b, g));
    boxes.push_back(box_of(triangles.back()));
    faces.push_back(g);
  }
  for (Index f = 0; f < static_cast<Index>(a.faces.size()); ++f) {
    if (is_wall(a, a.faces[f])) continue;
    const Triangle s = triangle(a, f);
    const Box box = box_of(s);
    for (std::size_t i = 0; i < faces.size(); ++i)
      if (boxes_meet(box, boxes[i]) && interiors_meet(s, triangles[i])) cells.push_back(measured(a, b, f, faces[i]));
  }
  return cells;
}

mpq_class shared_area_exact(const Triangle& s, const Triangle& t) {
  const Polygon<mpq_class> shared = clipped(moved<mpq_class>(s, s[0]), moved<mpq_class>(t, s[0]));
  mpq_class twice = 0;
  for (std::size_t i = 1; i + 1 < shared.size(); ++i) twice += cross(shared[0], shared[i], shared[i + 1]);
  return twice / 2;
}

}  // namespace terrane::support
