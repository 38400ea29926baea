// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/exact.hpp"

#include <algorithm>
#include <cmath>

namespace terrane::support {
namespace {

struct Split {
  double high, low;
};

Split two_sum(double a, double b) {
  const double sum = a + b, b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}

/// Whether b - a is exact, and so short that products of two such differences are.
bool is_short_step(double a, double b) {
  const Split step = two_sum(b, -a);
  return step.low == 0 && static_cast<float>(step.high) == step.high;
}

mpq_class cross(Point2 a, Point2 b, Point2 c) {
  const mpq_class ax(a.x), ay(a.y);
  return (mpq_class(b.x) - ax) * (mpq_class(c.y) - ay) - (mpq_class(b.y) - ay) * (mpq_class(c.x) - ax);
}

bool edge_separates(const Triangle& s, const Triangle& t) {
  for (int k = 0; k < 3; ++k) {
    const Point2 a = s[k], b = s[(k + 1) % 3];
    if (turn(a, b, t[0]) <= 0 && turn(a, b, t[1]) <= 0 && turn(a, b, t[2]) <= 0) return true;
  }
  return false;
}

bool within_exactly(Point2 p, Point2 a, Point2 b, double reach) {
  const mpq_class dx = mpq_class(b.x) - a.x, dy = mpq_class(b.y) - a.y;
  mpq_class px = mpq_class(p.x) - a.x, py = mpq_class(p.y) - a.y;
  const mpq_class length2 = dx * dx + dy * dy;
  if (length2 != 0) {
    mpq_class t = (px * dx + py * dy) / length2;
    t = t < 0 ? mpq_class(0) : t > 1 ? mpq_class(1) : t;
    px -= t * dx, py -= t * dy;
  }
  return px * px + py * py <= mpq_class(reach) * mpq_class(reach);
}

}  // namespace

void ExactSum::add(double value) {
  int kept = 0;
  for (int i = 0; i < count_; ++i) {
    const Split s = two_sum(value, parts_[i]);
    if (s.low != 0) parts_[kept++] = s.low;
    value = s.high;
  }
  if (value != 0) parts_[kept++] = value;
  count_ = kept;
}

void ExactSum::add_product(double a, double b) {
  const double product = a * b;
  add(std::fma(a, b, -product));
  add(product);
}

int ExactSum::sign() const { return count_ == 0 ? 0 : parts_[count_ - 1] > 0 ? 1 : -1; }

double ExactSum::value() const {
  double sum = 0;
  for (int i = 0; i < count_; ++i) sum += parts_[i];
  return sum;
}

mpq_class ExactSum::rational() const {
  mpq_class sum = 0;
  for (int i = 0; i < count_; ++i) sum += mpq_class(parts_[i]);
  return sum;
}

int turn(Point2 a, Point2 b, Point2 c) {
  if (a == b || b == c || c == a) return 0;
  const double l = (b.x - a.x) * (c.y - a.y), r = (b.y - a.y) * (c.x - a.x), d = l - r;
  const double doubt = 1e-15 * (std::fabs(l) + std::fabs(r)) + 1e-300;
  if (d > doubt) return 1;
  if (d < -doubt) return -1;
  if (is_short_step(a.x, b.x) && is_short_step(a.y, b.y) && is_short_step(a.x, c.x) && is_short_step(a.y, c.y))
    return (d > 0) - (d < 0);
  for (const double v : {a.x, a.y, b.x, b.y, c.x, c.y})
    if (!products_are_exact(v)) return sgn(cross(a, b, c));
  ExactSum sum;
  sum.add_product(a.x, b.y), sum.add_product(-a.y, b.x);
  sum.add_product(b.x, c.y), sum.add_product(-b.y, c.x);
  sum.add_product(c.x, a.y), sum.add_product(-c.y, a.x);
  return sum.sign();
}

mpq_class area2_exact(Point2 a, Point2 b, Point2 c) { return cross(a, b, c); }

bool interiors_meet(const Triangle& s, const Triangle& t) { return !edge_separates(s, t) && !edge_separates(t, s); }

bool inside_segment(Point2 a, Point2 b, Point2 p) {
  if (p == a || p == b) return false;
  if (std::min(a.x, b.x) > p.x || p.x > std::max(a.x, b.x) || std::min(a.y, b.y) > p.y || p.y > std::max(a.y, b.y))
    return false;
  return turn(a, b, p) == 0;
}

bool within(Point2 p, Point2 a, Point2 b, double reach) {
  const long double dx = static_cast<long double>(b.x) - a.x, dy = static_cast<long double>(b.y) - a.y;
  const long double px = static_cast<long double>(p.x) - a.x, py = static_cast<long double>(p.y) - a.y;
  const long double length2 = dx * dx + dy * dy;
  const long double t = length2 > 0 ? std::clamp((px * dx + py * dy) / length2, 0.0L, 1.0L) : 0;
  const long double distance = length(px - t * dx, py - t * dy);
  const long double doubt = 1e-18L * (std::fabs(px) + std::fabs(py) + std::fabs(dx) + std::fabs(dy));
  if (distance + doubt < reach) return true;
  if (distance - doubt > reach) return false;
  return within_exactly(p, a, b, reach);
}

bool within(Point2 p, const Triangle& t, double reach) {
  const int turns[3] = {turn(t[0], t[1], p), turn(t[1], t[2], p), turn(t[2], t[0], p)};
  if (turns[0] >= 0 && turns[1] >= 0 && turns[2] >= 0) return true;
  for (int k = 0; k < 3; ++k)
    if (turns[k] < 0 && within(p, t[k], t[(k + 1) % 3], reach)) return true;
  return false;
}

}  // namespace terrane::support
