// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <functional>

#include "core/tin.hpp"

namespace terrane {

/// How long a plan unit is along x and y at a height of the plane: for lengths asked for in metres where coordinates
/// are degrees. Without a function both are 1.
struct PlanMetric {
  std::function<Point2(double y)> units;

  Point2 at(double y) const { return units ? units(y) : Point2{1, 1}; }
  double distance(Point2 a, Point2 b) const {
    const Point2 unit = at((a.y + b.y) / 2);
    return std::hypot((b.x - a.x) * unit.x, (b.y - a.y) * unit.y);
  }
  /// The box of places within `distance` of p, and somewhat more.
  Box around(Point2 p, double distance) const {
    const Point2 unit = at(p.y);
    const double dx = 1.0000001 * distance / unit.x, dy = 1.0000001 * distance / unit.y;
    return {p.x - dx, p.y - dy, p.x + dx, p.y + dy};
  }
};

/// The point of the segment a b nearest to p as the metric has it, as a fraction from a to b.
inline double nearest_fraction(Point2 a, Point2 b, Point2 p, const PlanMetric& metric) {
  const Point2 unit = metric.at(p.y);
  const double ux = (b.x - a.x) * unit.x, uy = (b.y - a.y) * unit.y;
  const double vx = (p.x - a.x) * unit.x, vy = (p.y - a.y) * unit.y, squared = ux * ux + uy * uy;
  if (!(squared > 0)) return 0;
  return std::fmin(1.0, std::fmax(0.0, (vx * ux + vy * uy) / squared));
}

/// The point a fraction of the way from a to b, nearest to the exact one from either end.
inline Point2 point_along(Point2 a, Point2 b, double t) {
  if (t <= 0.5) return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
  return {b.x + (1 - t) * (a.x - b.x), b.y + (1 - t) * (a.y - b.y)};
}

}  // namespace terrane
