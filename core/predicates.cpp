// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/predicates.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <algorithm>
#include <limits>

namespace terrane {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Rational = CGAL::Exact_rational;

Kernel::Point_2 cgal(Point2 p) { return {p.x, p.y}; }

/// The rounding error of x = a - b (Knuth).
double difference_tail(double a, double b, double x) {
  const double bv = a - x, av = x + bv;
  return (a - av) + (bv - b);
}

/// The rounding error of x = a * b (Dekker); no fused multiply-add, which would be a library call on plain x86-64.
double product_tail(double a, double b, double x) {
  constexpr double splitter = 134217729.0;  // 2^27 + 1
  const double ca = splitter * a, ah = ca - (ca - a), al = a - ah;
  const double cb = splitter * b, bh = cb - (cb - b), bl = b - bh;
  return al * bl - (((x - ah * bh) - al * bh) - ah * bl);
}

Rational area2(Point2 a, Point2 b, Point2 c) {
  return (Rational(b.x) - Rational(a.x)) * (Rational(c.y) - Rational(a.y)) -
         (Rational(b.y) - Rational(a.y)) * (Rational(c.x) - Rational(a.x));
}

/// The area2_accurate that doubles cannot tell.
double area2_slowly(Point2 a, Point2 b, Point2 c) {
  const double d = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (!std::isfinite(d)) return d;
  const int sign = orientation_exact(a, b, c);
  if (sign == 0) return 0;
  using Quad = __float128;
  const Quad ql = (Quad(b.x) - a.x) * (Quad(c.y) - a.y), qr = (Quad(b.y) - a.y) * (Quad(c.x) - a.x), qd = ql - qr;
  const Quad size = (ql < 0 ? -ql : ql) + (qr < 0 ? -qr : qr), magnitude = qd < 0 ? -qd : qd;
  if (magnitude > size * Quad(1e-17) && magnitude > Quad(1e-300)) return static_cast<double>(qd);
  const double value = CGAL::to_double(area2(a, b, c));
  return value != 0 ? value : sign * std::numeric_limits<double>::denorm_min();
}

}  // namespace

int orientation_exact(Point2 a, Point2 b, Point2 c) {
  // Coordinates on a lattice or near each other subtract exactly; then two exact products decide, and exact zeros,
  // which grids are full of, cost nanoseconds instead of a rational.
  const double ux = b.x - a.x, uy = b.y - a.y, vx = c.x - a.x, vy = c.y - a.y;
  if (difference_tail(b.x, a.x, ux) == 0 && difference_tail(b.y, a.y, uy) == 0 && difference_tail(c.x, a.x, vx) == 0 &&
      difference_tail(c.y, a.y, vy) == 0) {
    const double l = ux * vy, r = uy * vx;
    const double size = std::max(std::fabs(l), std::fabs(r));
    const bool l_sound = l == 0 ? (ux == 0 || vy == 0) : std::fabs(l) > 1e-280;
    const bool r_sound = r == 0 ? (uy == 0 || vx == 0) : std::fabs(r) > 1e-280;
    if (l_sound && r_sound && size < 1e280) {
      if (l != r) return l > r ? 1 : -1;
      const double lt = l == 0 ? 0 : product_tail(ux, vy, l), rt = r == 0 ? 0 : product_tail(uy, vx, r);
      return lt > rt ? 1 : lt < rt ? -1 : 0;
    }
  }
  return static_cast<int>(CGAL::orientation(cgal(a), cgal(b), cgal(c)));
}

double area2_to_the_last_digit(Point2 a, Point2 b, Point2 c) {
  const double ux = b.x - a.x, uy = b.y - a.y, vx = c.x - a.x, vy = c.y - a.y;
  const double l = ux * vy, r = uy * vx, d = l - r;
  const double lost_ux = difference_tail(b.x, a.x, ux), lost_uy = difference_tail(b.y, a.y, uy);
  const double lost_vx = difference_tail(c.x, a.x, vx), lost_vy = difference_tail(c.y, a.y, vy);
  // But for what these lose: 1e-30 of the products.
  const double lost_l = product_tail(ux, vy, l) + ux * lost_vy + lost_ux * vy;
  const double lost_r = product_tail(uy, vx, r) + uy * lost_vx + lost_uy * vx;
  const double area = d + (difference_tail(l, r, d) + (lost_l - lost_r));
  const double size = std::fabs(l) + std::fabs(r);
  return std::fabs(area) > 1e-13 * size && std::fabs(area) > 1e-250 && size < 1e280 ? area : area2_slowly(a, b, c);
}

double area2_magnified(Point2 a, Point2 b, Point2 c) {
  const Rational half(0x1p600);
  return CGAL::to_double(area2(a, b, c) * half * half);
}

int in_circle_exact(Point2 a, Point2 b, Point2 c, Point2 d) {
  return static_cast<int>(CGAL::side_of_oriented_circle(cgal(a), cgal(b), cgal(c), cgal(d)));
}

}  // namespace terrane
