// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/plan/exact_place.hpp"

#include <algorithm>
#include <cmath>

#include "core/plan/crossing_point.hpp"
#include "core/plan/near_place.hpp"
#include "core/predicates.hpp"

namespace terrane {
namespace {

/// `at`, an exact place rounded to some digits, to the last: within an ulp of its coordinates.
Point2 refined(const ExactPlace& place, Point2 at) {
  const NearPlace near = near_place(place, at, 0);
  if (near.error <= 0x1p-60 * std::max(std::fabs(at.x), std::fabs(at.y)))
    return {at.x + near.offset.x, at.y + near.offset.y};
  const ExactPair exact = exact_pair(place);
  return {CGAL::to_double(exact.x), CGAL::to_double(exact.y)};
}

}  // namespace

Point2 crossing_of_long_segment(Point2 p, Point2 q, Point2 r, Point2 s, Point2 at) {
  const Point2 made = refined({ExactPlace::crossing, p, q, r, s}, at);
  return {p.x == q.x ? p.x : made.x, p.y == q.y ? p.y : made.y};
}

Point2 rounded(const ExactPlace& place) {
  if (place.kind == ExactPlace::ratio) {
    constexpr Point2 any{0, 0}, other{1, 1};
    const double to_p = std::fabs(place.dp), to_q = std::fabs(place.dq);
    const bool far = to_p > to_q;
    const Point2 at = point_on_segment(any, other, far ? place.q : place.p, far ? place.p : place.q,
                                       (far ? to_q : to_p) / (to_p + to_q));
    return is_long(place.p, place.q) ? refined(place, at) : at;
  }
  double to_r = area2_accurate(place.p, place.q, place.r), to_s = area2_accurate(place.p, place.q, place.s);
  if (std::fabs(to_r) + std::fabs(to_s) < tiny_area)
    to_r = area2_magnified(place.p, place.q, place.r), to_s = area2_magnified(place.p, place.q, place.s);
  return crossing_point(place.p, place.q, place.r, place.s, std::fabs(to_r), std::fabs(to_s));
}

double rounding_bound(const ExactPlace& place) {
  return place.kind == ExactPlace::ratio ? larger_bound(0, place.p, place.q) : larger_bound(0, place.r, place.s);
}

}  // namespace terrane
