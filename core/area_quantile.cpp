// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/area_quantile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/sum.hpp"

namespace terrane {
namespace {

struct Ranged {
  LinearPiece piece;
  double low, high;  // of the quantity
};

/// Bisects for the level; `at_most(piece, level)` is the area of a piece where the quantity is at most `level`.
template <class AtMost>
double bisect(std::vector<Ranged> active, double wanted, AtMost at_most) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Ranged& r : active) low = std::min(low, r.low), high = std::max(high, r.high);
  const double precision = 1e-13 * (high - low);
  low -= 1e-3 * (high - low);  // or level areas at the very bottom would be settled before they are the answer
  Sum settled;                 // area known to be below the bracket
  while (high - low > precision) {
    const double middle = low + 0.5 * (high - low);
    if (middle <= low || middle >= high) break;
    Sum below = settled;
    for (const Ranged& r : active) below.add(at_most(r.piece, middle));
    (below.value() >= wanted ? high : low) = middle;
    const auto outside = [&](const Ranged& r) {
      if (r.high <= low) settled.add(r.piece.area);
      return r.high <= low || r.low > high;
    };
    active.erase(std::remove_if(active.begin(), active.end(), outside), active.end());
  }
  // A level area that holds the answer has it exactly; the bracket only comes close.
  for (const Ranged& r : active)
    if (r.low == r.high) return r.low;
  return high;
}

}  // namespace

double area_at_most(const LinearPiece& piece, double level) {
  std::array<double, 3> v = piece.values;
  std::sort(v.begin(), v.end());
  if (level >= v[2]) return piece.area;
  if (level < v[0]) return 0;
  const double below = level - v[0], above = v[2] - level, range = v[2] - v[0];
  if (level <= v[1] && v[1] > v[0]) return piece.area * (below / range) * (below / (v[1] - v[0]));
  return piece.area * (1 - (above / range) * (above / (v[2] - v[1])));
}

double area_quantile(const std::vector<LinearPiece>& pieces, double share) {
  Sum area;
  std::vector<Ranged> active;
  for (const LinearPiece& p : pieces) {
    area.add(p.area);
    const auto [low, high] = std::minmax_element(p.values.begin(), p.values.end());
    active.push_back({p, *low, *high});
  }
  return bisect(std::move(active), share * area.value(), area_at_most);
}

double area_quantile_abs(const std::vector<LinearPiece>& pieces, double centre, double share) {
  Sum area;
  std::vector<Ranged> active;
  for (LinearPiece p : pieces) {
    area.add(p.area);
    for (double& v : p.values) v -= centre;
    const auto [low, high] = std::minmax_element(p.values.begin(), p.values.end());
    const double largest = std::max(std::fabs(*low), std::fabs(*high));
    const double smallest = *low > 0 ? *low : *high < 0 ? -*high : 0;
    active.push_back({p, smallest, largest});
  }
  return bisect(std::move(active), share * area.value(), [](const LinearPiece& p, double level) {
    if (level < 0) return 0.0;
    // Strictly below -level: a level piece at -level belongs to |value| <= level.
    const double under = area_at_most(p, std::nextafter(-level, -std::numeric_limits<double>::infinity()));
    return area_at_most(p, level) - under;
  });
}

}  // namespace terrane
