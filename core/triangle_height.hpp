// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "core/tin.hpp"

namespace terrane {

/// z between the ends of a segment: exact at both, never beyond them.
inline double mix(double z0, double z1, double t) { return t <= 0.5 ? z0 + (z1 - z0) * t : z1 + (z0 - z1) * (1 - t); }

/// How far along a -> b the projection of p lies, 0 to 1, by the longer coordinate.
inline double fraction_along(Point2 a, Point2 b, Point2 p) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double t = std::fabs(dx) >= std::fabs(dy) ? (p.x - a.x) / dx : (p.y - a.y) / dy;
  return std::clamp(t, 0.0, 1.0);
}

/// The point of segment a b nearest to p, as a fraction from a to b, and its distance: never too short, and too long by
/// 1e-12 of it at most.
double nearest_on_segment(Point2 a, Point2 b, Point2 p, double& distance);

/// The distance of p from a triangle with corners c (counter-clockwise): 0 inside, else never too short.
double distance_to_triangle(const Point2 (&c)[3], Point2 p);

/// The height at p of a triangle with corners c (counter-clockwise) and heights z: a convex combination with accurate
/// weights inside; outside the height of the nearest point of the triangle. A place a rounding error off a steep sliver
/// must not run away on the sliver's plane.
double height_on_triangle(const Point2 (&c)[3], const double (&z)[3], Point2 p);

/// How far a triangle with corners c and heights z rises per distance in plan.
double slope_of_triangle(const Point2 (&c)[3], const double (&z)[3]);

}  // namespace terrane
