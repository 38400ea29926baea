// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "core/tin.hpp"

namespace terrane {

/// Where on doubles the line p q crosses the segment r s, given how far r and s are from it: `to_r` and `to_s`, in some
/// unit, accurate and not negative. Accurate to about an ulp of the coordinates; those that p q holds constant are
/// kept.
inline Point2 crossing_point(Point2 p, Point2 q, Point2 r, Point2 s, double to_r, double to_s) {
  const Point2 low{std::min(r.x, s.x), std::min(r.y, s.y)}, high{std::max(r.x, s.x), std::max(r.y, s.y)};
  if (to_r > to_s) std::swap(to_r, to_s), std::swap(r, s);  // from the nearer end
  const double t = to_r / (to_r + to_s);
  const double x = p.x == q.x ? p.x : r.x + (s.x - r.x) * t, y = p.y == q.y ? p.y : r.y + (s.y - r.y) * t;
  return {std::clamp(x, low.x, high.x), std::clamp(y, low.y, high.y)};
}

/// The larger of `bound` and an upper bound of the error of a crossing_point on r s.
inline double larger_bound(double bound, Point2 r, Point2 s) {
  const auto along = [](double a, double b) {
    constexpr double half_ulp = 1.1102230246251566e-16;
    return std::fabs(b - a) * 1.5e-13 + std::max(std::fabs(a), std::fabs(b)) * half_ulp;
  };
  const double x = along(r.x, s.x), y = along(r.y, s.y);
  return x + y <= bound ? bound : std::max(bound, std::hypot(x, y));
}

}  // namespace terrane
