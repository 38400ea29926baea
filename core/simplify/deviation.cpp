// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/simplify/deviation.hpp"

#include "core/overlay.hpp"
#include "core/predicates.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

/// Whether a, on the line through p and q, lies on q's side of p.
bool ahead(Point2 p, Point2 a, Point2 q) {
  if (p.x != q.x) return (a.x > p.x) == (q.x > p.x) && a.x != p.x;
  return p.y != q.y && (a.y > p.y) == (q.y > p.y) && a.y != p.y;
}

}  // namespace

double Deviation::at(Index v, Index a, Index b, Index c) const {
  return std::fabs(z(v) - height_on_triangle({place(a), place(b), place(c)}, {z(a), z(b), z(c)}, place(v)));
}

Deviation::Way Deviation::leave_fan(Index first, Index at, Index q) const {
  const Point2 from = place(at), to = place(q);
  Index h = first;
  int turn = orientation(from, place(mesh_.to(h)), to);
  do {
    const Index across = next_in_face(h), b = mesh_.to(across);
    if (turn == 0 && ahead(from, place(mesh_.to(h)), to)) return {mesh_.to(h), none};
    const int next = orientation(from, place(b), to);
    if (next == 0 && ahead(from, place(b), to)) return {b, none};
    if (turn > 0 && next < 0) return {none, across};
    turn = next;
    h = mesh_.turn_left(h);
  } while (h != none && h != first);
  return {};
}

Deviation::Way Deviation::leave(Index at, Index q) const {
  if (mesh_.out[at] == none) return {};
  // Where heights begin to jump two fans have an edge in the same direction; the right one leads to q.
  const auto leads = [&](const Way& way) {
    return way.half_edge != none || way.vertex == q || (way.vertex != none && !(place(way.vertex) == place(q)));
  };
  if (const Way way = leave_fan(mesh_.out[at], at, q); leads(way)) return way;
  const auto& fans = mesh_.other_fans;
  auto fan = std::lower_bound(fans.begin(), fans.end(), at, [&](Index h, Index v) { return mesh_.from(h) < v; });
  for (; fan != fans.end() && mesh_.from(*fan) == at; ++fan)
    if (const Way way = leave_fan(*fan, at, q); leads(way)) return way;
  return {};
}

double Deviation::along(Index p, Index q, double limit) const {
  const Point2 from = place(p), to = place(q);
  const double zp = z(p), zq = z(q);
  double largest = 0;
  for (Index at = p; at != q;) {
    if (largest > limit) return largest;
    const Way way = leave(at, q);
    if (way.vertex != none) {
      at = way.vertex;
      largest = std::max(largest, std::fabs(z(at) - mix(zp, zq, fraction_along(from, to, place(at)))));
      continue;
    }
    if (way.half_edge == none) return INFINITY;
    Index h = way.half_edge;  // seen from the face before it: from the right of the line to its left
    for (at = none; at == none;) {
      const Index a = mesh_.from(h), b = mesh_.to(h);
      const double of_a = std::fabs(area2_accurate(from, to, place(a))),
                   of_b = std::fabs(area2_accurate(from, to, place(b)));
      const double of_p = std::fabs(area2_accurate(place(a), place(b), from)),
                   of_q = std::fabs(area2_accurate(place(a), place(b), to));
      const double d = mix(z(a), z(b), of_a / (of_a + of_b)) - mix(zp, zq, of_p / (of_p + of_q));
      largest = std::max(largest, std::fabs(d));
      if (largest > limit) return largest;
      const Index m = mesh_.mate[h];
      if (m == none) return INFINITY;
      const Index left = next_in_face(m), w = mesh_.to(left);  // m runs from b to a
      const int side = orientation(from, to, place(w));
      if (side == 0)
        at = w;
      else  // w left: the line goes on between the right end a and w
        h = side > 0 ? left : next_in_face(left);
    }
    largest = std::max(largest, std::fabs(z(at) - mix(zp, zq, fraction_along(from, to, place(at)))));
  }
  return largest;
}

double largest_difference(const Tin& a, const Tin& b, Context& context) {
  const Overlay both = overlay(a, b, {}, context);
  double largest = 0;
  for (Index f = 0; f < static_cast<Index>(both.faces.size()); ++f) {
    if (both.parents[f][0] == none || both.parents[f][1] == none) continue;
    for (int k = 0; k < 3; ++k) largest = std::max(largest, std::fabs(both.height(0, f, k) - both.height(1, f, k)));
  }
  return largest;
}

}  // namespace terrane
