// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/triangle_height.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/predicates.hpp"

namespace terrane {

double nearest_on_segment(Point2 a, Point2 b, Point2 p, double& distance) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double t = std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  distance = std::hypot(t * dx - (p.x - a.x), t * dy - (p.y - a.y));  // far from the origin places have fewer digits
  return t;
}

double height_on_triangle(const Point2 (&c)[3], const double (&z)[3], Point2 p) {
  double w[3], total = 0;
  for (int k = 0; k < 3; ++k) {
    w[k] = area2_accurate(c[(k + 1) % 3], c[(k + 2) % 3], p);
    if (w[k] < 0) {
      double best = std::numeric_limits<double>::infinity(), height = 0;
      for (int i = 0; i < 3; ++i) {
        double d;
        const double t = nearest_on_segment(c[i], c[(i + 1) % 3], p, d);
        if (d < best) best = d, height = mix(z[i], z[(i + 1) % 3], t);
      }
      return height;
    }
    total += w[k];
  }
  // Relative to the heaviest corner: a level face stays level to the last bit.
  const int base = w[0] >= w[1] && w[0] >= w[2] ? 0 : w[1] >= w[2] ? 1 : 2;
  double height = z[base];
  for (int k = 0; k < 3; ++k)
    if (k != base) height += (z[k] - z[base]) * (w[k] / total);
  const auto [low, high] = std::minmax({z[0], z[1], z[2]});
  return std::clamp(height, low, high);
}

}  // namespace terrane
