// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include "core/overlay.hpp"
#include "ops/volume_report.hpp"

namespace terrane {
namespace {

/// The part of a triangle's area where a function linear on it, with these values at the corners, is above a bound.
double part_above(std::array<double, 3> v, double bound) {
  std::sort(v.begin(), v.end());
  const double a = v[0] - bound, b = v[1] - bound, c = v[2] - bound;
  if (c <= 0) return 0;
  if (a >= 0) return 1;
  if (b <= 0) return c / (c - a) * (c / (c - b));
  return 1 - a / (a - c) * (a / (a - b));
}

void add_face(SpaceAreas& areas, const std::array<Point, 3>& p, const std::array<double, 3>& dz, double tolerance,
              const Crs& crs, const AreaScale& scale) {
  double area = std::fabs((p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x)) / 2;
  if (scale) area *= scale((p[0].x + p[1].x + p[2].x) / 3, (p[0].y + p[1].y + p[2].y) / 3);
  area *= steepness(p[0], p[1], p[2], crs);
  const double fill = part_above(dz, tolerance), cut = part_above({-dz[0], -dz[1], -dz[2]}, tolerance);
  areas.fill += area * fill;
  areas.cut += area * cut;
  areas.same += area * std::max(0.0, 1 - fill - cut);
}

}  // namespace

SpaceAreas space_areas(const Tin& surface, const Tin* reference, double level, double tolerance, const Crs& crs,
                       const AreaScale& scale, Context& context) {
  SpaceAreas areas;
  std::array<Point, 3> p;
  std::array<double, 3> dz;
  if (!reference) {
    for (const Face& f : surface.faces) {
      if (is_wall(surface, f)) continue;
      for (int k = 0; k < 3; ++k) p[k] = surface.vertices[f[k]], dz[k] = p[k].z - level;
      add_face(areas, p, dz, tolerance, crs, scale);
    }
    return areas;
  }
  const Overlay both = overlay(surface, *reference, {}, context);
  for (Index f = 0; f < static_cast<Index>(both.faces.size()); ++f) {
    if (both.parents[f][0] == none || both.parents[f][1] == none) continue;
    for (int k = 0; k < 3; ++k) {
      const Point2 at = both.points[both.faces[f][k]];
      p[k] = {at.x, at.y, both.height(0, f, k)};
      dz[k] = p[k].z - both.height(1, f, k);
    }
    add_face(areas, p, dz, tolerance, crs, scale);
  }
  return areas;
}

}  // namespace terrane
