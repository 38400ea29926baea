// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "core/tin.hpp"

namespace terrane {

/// Are 13 digits of a segment too few to keep a place on it within 1e-6? Then it is computed to the last digit.
inline bool is_long(Point2 r, Point2 s) { return std::max(std::fabs(s.x - r.x), std::fabs(s.y - r.y)) > 0x1p17; }

/// A double place where the line p q crosses the segment r s, given how far r and s are from the line: `to_r` and
/// `to_s`, in some unit, to 13 digits and not negative. Coordinates that p q holds constant are kept; never beyond r
/// and s.
inline Point2 point_on_segment(Point2 p, Point2 q, Point2 r, Point2 s, double to_r, double to_s) {
  const Point2 low{std::min(r.x, s.x), std::min(r.y, s.y)}, high{std::max(r.x, s.x), std::max(r.y, s.y)};
  if (to_r > to_s) std::swap(to_r, to_s), std::swap(r, s);  // from the nearer end
  const double t = to_r / (to_r + to_s);
  const double x = p.x == q.x ? p.x : r.x + (s.x - r.x) * t, y = p.y == q.y ? p.y : r.y + (s.y - r.y) * t;
  return {std::clamp(x, low.x, high.x), std::clamp(y, low.y, high.y)};
}

/// `at`, a point_on_segment, to the last digit.
Point2 crossing_of_long_segment(Point2 p, Point2 q, Point2 r, Point2 s, Point2 at);

/// The point_on_segment, within larger_bound.
inline Point2 crossing_point(Point2 p, Point2 q, Point2 r, Point2 s, double to_r, double to_s) {
  const Point2 at = point_on_segment(p, q, r, s, to_r, to_s);
  return is_long(r, s) ? crossing_of_long_segment(p, q, r, s, at) : at;
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
