// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "core/tin.hpp"

namespace terrane {

/// Are 13 digits of a segment too few to keep a place on it within 1e-6? Then it is computed to the last digit.
inline bool is_long(Point2 r, Point2 s) { return std::max(std::fabs(s.x - r.x), std::fabs(s.y - r.y)) > 0x1p17; }

/// A double place where the line p q crosses the segment from `near` to `far`, its nearer and its farther end: a
/// fraction t of the way, to 13 digits, at most a half. Coordinates that p q holds constant are kept; never beyond the
/// ends.
inline Point2 point_on_segment(Point2 p, Point2 q, Point2 near, Point2 far, double t) {
  return {p.x == q.x ? p.x : near.x + (far.x - near.x) * t, p.y == q.y ? p.y : near.y + (far.y - near.y) * t};
}

/// `at`, a point_on_segment, to the last digit.
Point2 crossing_of_long_segment(Point2 p, Point2 q, Point2 r, Point2 s, Point2 at);

/// The point_on_segment, within larger_bound.
inline Point2 crossing_point(Point2 p, Point2 q, Point2 near, Point2 far, double t) {
  const Point2 at = point_on_segment(p, q, near, far, t);
  return is_long(near, far) ? crossing_of_long_segment(p, q, near, far, at) : at;
}

/// The same, given how far r and s are from the line p q, in some unit, to 13 digits and not negative.
inline Point2 crossing_point(Point2 p, Point2 q, Point2 r, Point2 s, double to_r, double to_s) {
  const bool far = to_r > to_s;
  return crossing_point(p, q, far ? s : r, far ? r : s, std::min(to_r, to_s) / (to_r + to_s));
}

/// The larger of `bound` and an upper bound of the error of a crossing_point on r s.
inline double larger_bound(double bound, Point2 r, Point2 s) {
  const double relative = is_long(r, s) ? 1e-16 : 1.5e-13;
  const auto along = [&](double a, double b) {
    constexpr double half_ulp = 1.1102230246251566e-16;
    return std::fabs(b - a) * relative + std::max(std::fabs(a), std::fabs(b)) * half_ulp;
  };
  const double x = along(r.x, s.x), y = along(r.y, s.y);
  return x + y <= bound ? bound : std::max(bound, std::hypot(x, y));
}

}  // namespace terrane
