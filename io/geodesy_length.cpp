// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "io/geodesy_osr.hpp"

// Lengths on the ellipsoid of lines that are straight in degrees.
namespace terrane {

namespace {

constexpr double degree = std::numbers::pi / 180;

struct Spheroid {
  double semi_major, e2;

  /// Metres per degree along the meridian and across it.
  Point2 metres_per_degree(double latitude) const {
    const double s = std::sin(latitude * degree), w2 = 1 - e2 * s * s, n = semi_major / std::sqrt(w2);
    return {n * std::cos(latitude * degree) * degree, n * (1 - e2) / w2 * degree};
  }
};

void check_latitude(double latitude) {
  if (std::fabs(latitude) <= 90 + 1e-9) return;
  throw Error(ErrorKind::input, "outside-crs",
              "a latitude beyond 90 degrees: " + std::to_string(latitude) +
                  "; if these are not degrees, say what they are with crs");
}

}  // namespace

double line_length(const Crs& crs, Point2 a, Point2 b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  if (!crs.known() || !crs.geographic()) return std::hypot(dx, dy);
  check_latitude(a.y);
  check_latitude(b.y);
  const double f = crs.inside().inverse_flattening == 0 ? 0 : 1 / crs.inside().inverse_flattening;
  const Spheroid spheroid{crs.inside().semi_major, f * (2 - f)};
  // Gauss and Legendre's five places, in pieces so short that the radii are all but polynomials there.
  constexpr double place[] = {0, 0.5384693101056831, -0.5384693101056831, 0.9061798459386640, -0.9061798459386640};
  constexpr double weight[] = {0.5688888888888889, 0.4786286704993665, 0.4786286704993665, 0.2369268850561891,
                               0.2369268850561891};
  const int pieces = static_cast<int>(std::clamp(std::ceil(std::max(std::fabs(dx), std::fabs(dy)) / 0.5), 1.0, 1e4));
  double sum = 0;
  for (int k = 0; k < pieces; ++k)
    for (int i = 0; i < 5; ++i) {
      const Point2 unit = spheroid.metres_per_degree(a.y + dy * (k + 0.5 + 0.5 * place[i]) / pieces);
      sum += weight[i] * std::hypot(dx * unit.x, dy * unit.y);
    }
  return sum / 2 / pieces;
}

}  // namespace terrane
