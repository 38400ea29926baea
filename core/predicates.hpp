// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "core/tin.hpp"

// Exact signs on input coordinates, and values good to a stated relative error.
namespace terrane {

/// The exact sign of the area of the triangle a b c by expansions; the slow path of `orientation`.
int orientation_exact(Point2 a, Point2 b, Point2 c);

/// The filters are Shewchuk's (1997); underflow, which his bounds leave out, costs less than this.
constexpr double underflow_bound = 1e-300;

/// The sign of an area l - r, the difference of two products of coordinate differences, is beyond doubt above this:
/// bound A.
inline double orientation_bound(double l, double r) {
  return 3.3306690738754716e-16 * (std::fabs(l) + std::fabs(r)) + underflow_bound;
}

/// +1 when a b c turn left, -1 right, 0 collinear: exact.
inline int orientation(Point2 a, Point2 b, Point2 c) {
  const double l = (b.x - a.x) * (c.y - a.y), r = (b.y - a.y) * (c.x - a.x), d = l - r;
  const double bound = orientation_bound(l, r);
  if (d > bound) return 1;
  if (d < -bound) return -1;
  return orientation_exact(a, b, c);
}

/// Twice the signed area of a b c with the exact sign and, above tiny_area, a relative error of 3e-16; several times
/// slower than area2_accurate on well-shaped triangles.
double area2_to_the_last_digit(Point2 a, Point2 b, Point2 c);

/// Twice the signed area of a b c with the exact sign (0 only when collinear) and, above tiny_area, a relative error
/// below 1e-13.
inline double area2_accurate(Point2 a, Point2 b, Point2 c) {
  const double l = (b.x - a.x) * (c.y - a.y), r = (b.y - a.y) * (c.x - a.x), d = l - r;
  if (std::fabs(d) > 4e-3 * (std::fabs(l) + std::fabs(r)) && std::fabs(d) > 1e-280) return d;
  return area2_to_the_last_digit(a, b, c);
}

/// Of a face in plan.
inline double area2_accurate(const Tin& tin, const Face& f) {
  return area2_accurate(plan(tin.vertices[f[0]]), plan(tin.vertices[f[1]]), plan(tin.vertices[f[2]]));
}

/// The sign of a * b - c * d for non-negative factors, exact but for underflow.
inline int compare_products(double a, double b, double c, double d) {
  const double l = a * b, r = c * d;
  if (l != r) return l < r ? -1 : 1;
  const double el = std::fma(a, b, -l), er = std::fma(c, d, -r);
  return el < er ? -1 : el > er ? 1 : 0;
}

/// Areas whose sum is below this are compared magnified: doubles near the smallest one have few digits.
constexpr double tiny_area = 1e-280;

/// 2^1200 times the area2_accurate of less than tiny_area, to all digits.
double area2_magnified(Point2 a, Point2 b, Point2 c);

/// The slow path of `in_circle`.
int in_circle_exact(Point2 a, Point2 b, Point2 c, Point2 d);

/// The sign of the in-circle test of d against the circle through a, b, c (counter-clockwise): +1 inside. Exact.
/// Filter: in-circle bound A.
inline int in_circle(Point2 a, Point2 b, Point2 c, Point2 d) {
  const double ax = a.x - d.x, ay = a.y - d.y, bx = b.x - d.x, by = b.y - d.y, cx = c.x - d.x, cy = c.y - d.y;
  const double bc = bx * cy, cb = cx * by, ca = cx * ay, ac = ax * cy, ab = ax * by, ba = bx * ay;
  const double la = ax * ax + ay * ay, lb = bx * bx + by * by, lc = cx * cx + cy * cy;
  const double det = la * (bc - cb) + lb * (ca - ac) + lc * (ab - ba);
  const double size = la * (std::fabs(bc) + std::fabs(cb)) + lb * (std::fabs(ca) + std::fabs(ac)) +
                      lc * (std::fabs(ab) + std::fabs(ba));
  const double bound = 1.1102230246251577e-15 * size + underflow_bound;
  if (det > bound) return 1;
  if (det < -bound) return -1;
  return in_circle_exact(a, b, c, d);
}

}  // namespace terrane
