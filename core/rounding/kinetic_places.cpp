// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rounding/kinetic_places.hpp"

#include <algorithm>
#include <optional>

#include "core/predicates.hpp"

namespace terrane {
namespace {

constexpr double half_ulp = 0x1p-53;
constexpr double underflow = 1e-290;  // products smaller than this lose their tails

double two_sum(double a, double b, double& tail) {
  const double s = a + b, bv = s - a;
  tail = (a - (s - bv)) + (b - bv);
  return s;
}

double two_product(double a, double b, double& tail) {  // Dekker (1971)
  constexpr double splitter = 134217729.0;
  const double p = a * b, ca = splitter * a, ah = ca - (ca - a), al = a - ah;
  const double cb = splitter * b, bh = cb - (cb - b), bl = b - bh;
  tail = al * bl - (((p - ah * bh) - al * bh) - ah * bl);
  return p;
}

}  // namespace

Difference difference(double from, double from_offset, double to, double to_offset) {
  double t1, t2, t3;
  const double d = two_sum(to, -from, t1), o = two_sum(to_offset, -from_offset, t2), high = two_sum(d, o, t3);
  return {high, t3 + (t1 + t2), std::fabs(d) + std::fabs(o)};
}

bool KineticPlaces::lift(Index v) {
  if (slot_[v] != none) return false;
  const ExactPlace place = place_(v);
  if (place.kind == ExactPlace::input) return false;
  const NearPlace made = near_place(place, points_[v], v);
  if (made.plain()) {
    if (made.at == points_[v]) return false;
  } else if (std::max(std::fabs(made.offset.x), std::fabs(made.offset.y)) <= made.error &&
             exact_pair(place) == ExactPair{points_[v].x, points_[v].y}) {
    return false;
  }
  slot_[v] = static_cast<Index>(places_.size());
  places_.push_back(made);
  lifted_.push_back(v);
  return true;
}

bool KineticPlaces::on_one_line(const NearPlace& a, const NearPlace& b, const NearPlace& c) const {
  const NearPlace* corners[3] = {&a, &b, &c};
  std::optional<ExactPlace> crossings[3];
  const ExactPlace* crossing = nullptr;
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < k; ++j)
      if (corners[k]->plain() && corners[j]->plain() && corners[k]->at == corners[j]->at) return true;
    if (corners[k]->plain()) continue;
    crossings[k] = place_(corners[k]->vertex);
    if (crossings[k]->kind == ExactPlace::crossing) crossing = &*crossings[k];
  }
  if (!crossing) return false;
  const auto holds = [&](Point2 from, Point2 to) {
    for (int k = 0; k < 3; ++k) {
      const auto& e = crossings[k];
      const bool on = corners[k]->plain() ? orientation(from, to, corners[k]->at) == 0
                      : e                 ? (e->p == from && e->q == to) || (e->r == from && e->s == to)
                                          : false;
      if (!on) return false;
    }
    return true;
  };
  return holds(crossing->p, crossing->q) || holds(crossing->r, crossing->s);
}

ExactPair KineticPlaces::exact(const NearPlace& place) const {
  return place.plain() ? ExactPair{place.at.x, place.at.y} : exact_pair(place_(place.vertex));
}

Approximate area2(const NearPlace& a, const NearPlace& b, const NearPlace& c) {
  const Difference ux = difference(a.at.x, a.offset.x, b.at.x, b.offset.x);
  const Difference uy = difference(a.at.y, a.offset.y, b.at.y, b.offset.y);
  const Difference vx = difference(a.at.x, a.offset.x, c.at.x, c.offset.x);
  const Difference vy = difference(a.at.y, a.offset.y, c.at.y, c.offset.y);
  double lt, rt, dt;
  const double l = two_product(ux.high, vy.high, lt), r = two_product(uy.high, vx.high, rt);
  lt += ux.high * vy.low + ux.low * vy.high;
  rt += uy.high * vx.low + uy.low * vx.high;
  const double d = two_sum(l, -r, dt), value = d + (dt + (lt - rt));
  const double wide = a.error + b.error + c.error;
  const double error = 0x1p-98 * (ux.size * vy.size + uy.size * vx.size) +
                       1.001 * wide * (ux.size + uy.size + vx.size + vy.size + 2 * wide);
  if (value == 0 && error == 0) return {};
  return {value, error + 2 * half_ulp * std::fabs(value) + underflow};
}

Rational area2(const ExactPair& a, const ExactPair& b, const ExactPair& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

int orientation(const KineticPlaces& places, const NearPlace& a, const NearPlace& b, const NearPlace& c) {
  if (a.plain() && b.plain() && c.plain()) return orientation(a.at, b.at, c.at);
  // Offsets change an area by little: most are decided without them.
  const double ux = b.at.x - a.at.x, uy = b.at.y - a.at.y, vx = c.at.x - a.at.x, vy = c.at.y - a.at.y;
  const double l = ux * vy, r = uy * vx, reach = a.reach() + b.reach() + c.reach();
  const double error = 4.5e-16 * (std::fabs(l) + std::fabs(r)) +
                       1.001 * reach * (std::fabs(ux) + std::fabs(uy) + std::fabs(vx) + std::fabs(vy) + 2 * reach) +
                       underflow;
  if (std::fabs(l - r) > error) return l > r ? 1 : -1;
  if (const Approximate area = area2(a, b, c); area.decided()) return area.sign();
  if (places.on_one_line(a, b, c)) return 0;
  return static_cast<int>(CGAL::sign(area2(places.exact(a), places.exact(b), places.exact(c))));
}

}  // namespace terrane
