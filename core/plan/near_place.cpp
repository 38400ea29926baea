// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/plan/near_place.hpp"

#include <algorithm>
#include <limits>

namespace terrane {
namespace {

using Quad = __float128;
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double quad_unit = 0x1p-110, half_ulp = 0x1p-53;

Quad magnitude(Quad x) { return x < 0 ? -x : x; }

/// How an exact place divides the segment it lies on: the distances of the ends from it, of opposite sign, in a unit.
struct Division {
  Point2 from, to;
  Quad at_from, at_to;
  Quad error;  // of each distance
};

Division division(const ExactPlace& place) {
  if (place.kind == ExactPlace::ratio) return {place.p, place.q, place.dp, place.dq, 0};
  const Quad dx = Quad(place.q.x) - place.p.x, dy = Quad(place.q.y) - place.p.y;
  Division made{place.r, place.s, 0, 0, 0};
  const auto distance = [&](Point2 v) {
    const Quad l = dx * (Quad(v.y) - place.p.y), r = dy * (Quad(v.x) - place.p.x);
    made.error = std::max(made.error, (magnitude(l) + magnitude(r)) * quad_unit);
    return l - r;
  };
  made.at_from = distance(place.r);
  made.at_to = distance(place.s);
  return made;
}

}  // namespace

ExactPair exact_pair(const ExactPlace& place) {
  if (place.kind == ExactPlace::lattice) return {place.p.x, place.p.y};
  const bool ratio = place.kind == ExactPlace::ratio;
  const Point2 from = ratio ? place.p : place.r, to = ratio ? place.q : place.s;
  const auto distance = [&](Point2 v) -> Rational {
    return (Rational(place.q.x) - Rational(place.p.x)) * (Rational(v.y) - Rational(place.p.y)) -
           (Rational(place.q.y) - Rational(place.p.y)) * (Rational(v.x) - Rational(place.p.x));
  };
  const Rational at_from = ratio ? Rational(place.dp) : distance(from);
  const Rational at_to = ratio ? Rational(place.dq) : distance(to);
  const Rational t = at_from / (at_from - at_to);
  return {Rational(from.x) + t * (Rational(to.x) - Rational(from.x)),
          Rational(from.y) + t * (Rational(to.y) - Rational(from.y))};
}

NearPlace near_place(const ExactPlace& place, Point2 rounded, Index v) {
  if (place.kind == ExactPlace::lattice) return {place.p, {}, 0, none};
  const Division d = division(place);
  const Quad span = d.at_from - d.at_to, t = d.at_from / span;
  const Quad dx = Quad(d.to.x) - d.from.x, dy = Quad(d.to.y) - d.from.y;
  const Quad ox = Quad(d.from.x) - rounded.x + t * dx, oy = Quad(d.from.y) - rounded.y + t * dy;
  const Quad length = std::max(magnitude(dx), magnitude(dy));
  const Quad t_error = 2 * d.error / magnitude(span) + quad_unit;
  NearPlace made{rounded, {static_cast<double>(ox), static_cast<double>(oy)}, 0, v};
  made.error = static_cast<double>(length * (t_error + quad_unit)) +
               2 * half_ulp * std::max(std::fabs(made.offset.x), std::fabs(made.offset.y)) + 1e-320;
  if (!(made.error < 1e-3)) made = {rounded, {}, infinite, v};  // lines too nearly parallel for 113 bits
  return made;
}

}  // namespace terrane
