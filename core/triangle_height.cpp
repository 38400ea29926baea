// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/triangle_height.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/predicates.hpp"

namespace terrane {

double nearest_on_segment(Point2 a, Point2 b, Point2 p, double& distance) {
  constexpr double up = 1 + 1e-12;
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double squared = dx * dx + dy * dy;  // tiny: its ends are one place
  const double along = (p.x - a.x) * dx + (p.y - a.y) * dy, left = (b.x - p.x) * dx + (b.y - p.y) * dy;
  if (!(along > 0) || !(squared > tiny_area)) {
    distance = up * std::hypot(p.x - a.x, p.y - a.y);
    return 0;
  }
  if (!(left > 0)) {
    distance = up * std::hypot(p.x - b.x, p.y - b.y);
    return 1;
  }
  distance = up * std::fabs(area2_accurate(a, b, p)) / std::hypot(dx, dy);
  return std::min(along / squared, 1.0);
}

double distance_to_triangle(const Point2 (&c)[3], Point2 p) {
  double least = std::numeric_limits<double>::infinity();
  bool inside = true;
  for (int k = 0; k < 3; ++k) {
    const Point2 a = c[k], b = c[(k + 1) % 3];
    inside = inside && orientation(a, b, p) >= 0;
    double d;
    nearest_on_segment(a, b, p, d);
    least = std::min(least, d);
  }
  return inside ? 0 : least;
}

namespace {

/// Of the point of the triangle's border nearest to p.
double height_on_border(const Point2 (&c)[3], const double (&z)[3], Point2 p) {
  double best = std::numeric_limits<double>::infinity(), height = 0;
  for (int i = 0; i < 3; ++i) {
    double d;
    const double t = nearest_on_segment(c[i], c[(i + 1) % 3], p, d);
    if (d < best) best = d, height = mix(z[i], z[(i + 1) % 3], t);
  }
  return height;
}

/// Is the triangle so thin, askew in its box, that doubles leave its areas few digits?
bool is_askew(const Point2 (&c)[3], double area2) {
  const double width = std::max({c[0].x, c[1].x, c[2].x}) - std::min({c[0].x, c[1].x, c[2].x});
  const double height = std::max({c[0].y, c[1].y, c[2].y}) - std::min({c[0].y, c[1].y, c[2].y});
  return width * height > 4 * area2;
}

}  // namespace

double height_on_triangle(const Point2 (&c)[3], const double (&z)[3], Point2 p) {
  double w[3] = {area2_accurate(c[1], c[2], p), area2_accurate(c[2], c[0], p), area2_accurate(c[0], c[1], p)};
  if (std::min({w[0], w[1], w[2]}) < 0) return height_on_border(c, z, p);
  double total = w[0] + w[1] + w[2];
  if (total < tiny_area) {
    for (int k = 0; k < 3; ++k) w[k] = area2_magnified(c[(k + 1) % 3], c[(k + 2) % 3], p);
    total = w[0] + w[1] + w[2];
  } else if (is_askew(c, total)) {
    for (int k = 0; k < 3; ++k) w[k] = area2_to_the_last_digit(c[(k + 1) % 3], c[(k + 2) % 3], p);
    total = w[0] + w[1] + w[2];
  }
  // Relative to the heaviest corner: a level face stays level to the last bit.
  const int heavier = w[1] >= w[2] ? 1 : 2, base = w[0] >= w[heavier] ? 0 : heavier;
  const int i = base == 0, j = 2 - (base == 2);
  const double height = z[base] + (z[i] - z[base]) * (w[i] / total) + (z[j] - z[base]) * (w[j] / total);
  return std::clamp(height, std::min({z[0], z[1], z[2]}), std::max({z[0], z[1], z[2]}));
}

double slope_of_triangle(const Point2 (&c)[3], const double (&z)[3]) {
  const double ux = c[1].x - c[0].x, uy = c[1].y - c[0].y, vx = c[2].x - c[0].x, vy = c[2].y - c[0].y;
  const double du = z[1] - z[0], dv = z[2] - z[0];
  return std::hypot(vy * du - uy * dv, ux * dv - vx * du) / area2_accurate(c[0], c[1], c[2]);
}

}  // namespace terrane
