// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmpxx.h>

#include <array>
#include <cmath>

#include "core/tin.hpp"

// Exact arithmetic on doubles for judging results, apart from that of the core: sums of products as expansions
// (Shewchuk 1997), everything else in rationals.
namespace terrane::support {

/// A sum of doubles and of products of two, kept exactly. Precondition: no overflow, and no product that underflows
/// (`products_are_exact`).
class ExactSum {
 public:
  void add(double value);
  void add_product(double a, double b);
  int sign() const;
  double value() const;  // to about an ulp
  mpq_class rational() const;

 private:
  // Smallest first, non-overlapping, without zeros: never more than all bits of a double's range hold.
  std::array<double, 48> parts_;
  int count_ = 0;
};

/// Whether products of two such coordinates lose nothing below the smallest double.
inline bool products_are_exact(double v) { return v == 0 || (v > 1e-130 && v < 1e130) || (v < -1e-130 && v > -1e130); }

/// +1 when a b c turn left, -1 right, 0 collinear: exact.
int turn(Point2 a, Point2 b, Point2 c);

/// Twice the signed area of a b c, exactly.
mpq_class area2_exact(Point2 a, Point2 b, Point2 c);

using Triangle = std::array<Point2, 3>;

/// Of differences of doubles, whose squares neither overflow nor underflow here; std::hypot minds that and is slow.
inline long double length(long double x, long double y) { return std::sqrt(x * x + y * y); }

/// Whether two counter-clockwise triangles share more than a border: exact.
bool interiors_meet(const Triangle& s, const Triangle& t);

/// Whether p lies strictly between a and b on their segment: exact.
bool inside_segment(Point2 a, Point2 b, Point2 p);

/// Whether p is at most `reach` away from the segment a b, or from the triangle: exact.
bool within(Point2 p, Point2 a, Point2 b, double reach);
bool within(Point2 p, const Triangle& t, double reach);

}  // namespace terrane::support
