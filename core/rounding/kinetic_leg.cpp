// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>

#include "core/rounding/kinetic_places.hpp"

namespace terrane {
namespace {

constexpr int undecided = 2;

/// The sign of a * d - b * c, or `undecided`.
int compare_products(const Approximate& a, const Approximate& d, const Approximate& b, const Approximate& c) {
  const double l = a.value * d.value, r = b.value * c.value;
  const double error = std::fabs(a.value) * d.error + std::fabs(d.value) * a.error + a.error * d.error +
                       std::fabs(b.value) * c.error + std::fabs(c.value) * b.error + b.error * c.error +
                       1e-15 * (std::fabs(l) + std::fabs(r)) + 1e-300;
  return l - r > error ? 1 : r - l > error ? -1 : undecided;
}

Approximate negative(Approximate a) { return {-a.value, a.error}; }

/// The time of an event.
Approximate time_of(const Event& e) {
  if (e.at_end) return {1, 0};
  const double sum = e.before.value + e.after.value, error = e.before.error + e.after.error;
  if (!(sum > 4 * error)) return {0, std::numeric_limits<double>::infinity()};
  return {e.before.value / sum, 2 * error / sum + 1e-15};
}

/// One coordinate of a place, as a difference can take it.
struct Coordinate {
  double at, offset, error;
};
Coordinate coordinate(const NearPlace& p, bool x) {
  return x ? Coordinate{p.at.x, p.offset.x, p.error} : Coordinate{p.at.y, p.offset.y, p.error};
}

Approximate between(const Coordinate& from, const Coordinate& to) {
  const Difference d = difference(from.at, from.offset, to.at, to.offset);
  const bool exact = from.error == 0 && to.error == 0 && from.offset == 0 && to.offset == 0;
  return {d.high, exact && d.high == 0 ? 0 : from.error + to.error + 4e-16 * d.size};
}

}  // namespace

void Leg::first_events(const PlanarMesh& mesh, const std::vector<Index>& star, std::vector<Event>& events) const {
  events.clear();
  for (Index f : star) {
    Event event{f, mesh.faces[f], {}, {}, false};
    const int then = sign(event.corners, goal_);
    if (then > 0) continue;
    event.at_end = then == 0;
    if (!event.at_end) {
      event.before = area(event.corners, start_);
      event.after = negative(area(event.corners, goal_));
    }
    const int order = events.empty() ? -1 : compare_times(event, events[0]);
    if (order < 0) events.clear();
    if (order <= 0) events.push_back(event);
  }
}

int Leg::compare_times(const Event& e, const Event& f) const {
  if (e.at_end || f.at_end) return e.at_end - f.at_end;
  if (const int s = compare_products(e.before, f.after, f.before, e.after); s != undecided) return s;
  const Rational l = exact_area(e.corners, start_) * exact_area(f.corners, goal_);
  const Rational r = exact_area(f.corners, start_) * exact_area(e.corners, goal_);
  return static_cast<int>(CGAL::sign(Rational(r - l)));  // areas at the goal are negative
}

bool Leg::positive(const Event& now, const Face& face) const {
  if (now.at_end || (face[0] != vertex_ && face[1] != vertex_ && face[2] != vertex_)) return sign(face, goal_) > 0;
  // Its area then is (before * at the goal + after * at the start) / (before + after).
  const Approximate at_start = area(face, start_), at_goal = area(face, goal_);
  if (const int s = compare_products(now.before, at_goal, now.after, negative(at_start)); s != undecided) return s > 0;
  const Rational before = exact_area(now.corners, start_), after = -exact_area(now.corners, goal_);
  return before * exact_area(face, goal_) + after * exact_area(face, start_) > 0;
}

ExactPair Leg::position(const Event& now) const {
  if (now.at_end) return places_.exact(goal_);
  const Rational before = exact_area(now.corners, start_), after = -exact_area(now.corners, goal_);
  const Rational t = before / (before + after);
  const ExactPair from = places_.exact(start_), to = places_.exact(goal_);
  return {from.x + t * (to.x - from.x), from.y + t * (to.y - from.y)};
}

Alignment Leg::alignment(const Event& now) const {
  int k = 0;
  while (now.corners[k] != vertex_) ++k;
  const NearPlace p = places_.at(now.corners[(k + 1) % 3]), q = places_.at(now.corners[(k + 2) % 3]);
  const bool by_x = std::fabs(q.at.x - p.at.x) > std::fabs(q.at.y - p.at.y);
  const Coordinate from = coordinate(start_, by_x), to = coordinate(goal_, by_x);
  const Coordinate cp = coordinate(p, by_x), cq = coordinate(q, by_x);
  const Approximate time = time_of(now), way = between(from, to);
  const auto passes = [&](const Coordinate& c) -> Approximate {  // the vertex then minus c
    if (now.at_end) return between(c, to);
    const Approximate before = between(c, from);
    return {before.value + time.value * way.value, before.error + way.error + time.error * std::fabs(way.value) +
                                                       1e-15 * (std::fabs(before.value) + std::fabs(way.value))};
  };
  const Approximate span = between(cp, cq), after_p = passes(cp), after_q = passes(cq);
  if (!span.decided() || !after_p.decided() || !after_q.decided()) return exact_alignment(now, k);
  if (after_p.sign() == 0) return {none, now.corners[(k + 1) % 3]};
  if (after_q.sign() == 0) return {none, now.corners[(k + 2) % 3]};
  if (after_p.sign() != span.sign()) return {(k + 1) % 3, none};
  if (after_q.sign() == span.sign()) return {(k + 2) % 3, none};
  return {k, none};
}

Alignment Leg::exact_alignment(const Event& now, int k) const {
  const ExactPair v = position(now);
  const int after_v[2] = {(k + 1) % 3, (k + 2) % 3};
  const ExactPair p = places_.exact(places_.at(now.corners[after_v[0]]));
  const ExactPair q = places_.exact(places_.at(now.corners[after_v[1]]));
  if (v == p) return {none, now.corners[after_v[0]]};
  if (v == q) return {none, now.corners[after_v[1]]};
  const bool by_x = p.x != q.x;
  const Rational &cv = by_x ? v.x : v.y, &cp = by_x ? p.x : p.y, &cq = by_x ? q.x : q.y;
  if ((cv < cp) == (cp < cq)) return {after_v[0], none};
  if ((cv < cq) == (cq < cp)) return {after_v[1], none};
  return {k, none};
}

}  // namespace terrane
