// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include "core/level_order.hpp"
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

double area_of(const std::array<Point, 3>& p, const Crs& crs, const AreaScale& scale) {
  double area = std::fabs((p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x)) / 2;
  if (scale) area *= scale((p[0].x + p[1].x + p[2].x) / 3, (p[0].y + p[1].y + p[2].y) / 3);
  return area * steepness(p[0], p[1], p[2], crs);
}

void add_face(SpaceAreas& areas, double area, const std::array<double, 3>& dz, double tolerance) {
  const double fill = part_above(dz, tolerance), cut = part_above({-dz[0], -dz[1], -dz[2]}, tolerance);
  areas.fill += area * fill;
  areas.cut += area * cut;
  areas.same += area * std::max(0.0, 1 - fill - cut);
}

}  // namespace

std::vector<SpaceAreas> space_areas(const Tin& surface, const std::vector<double>& levels, double tolerance,
                                    const Crs& crs, const AreaScale& scale) {
  const LevelOrder level(levels);
  const std::size_t n = level.size();
  std::vector<SpaceAreas> areas(n);
  std::vector<double> above(n, 0), below(n, 0);  // of what lies above a level as a whole, and so above all lower ones
  std::array<Point, 3> p;
  for (const Face& f : surface.faces) {
    if (is_wall(surface, f)) continue;
    for (int k = 0; k < 3; ++k) p[k] = surface.vertices[f[k]];
    const double area = area_of(p, crs, scale);
    const auto [low, high] = std::minmax({p[0].z, p[1].z, p[2].z});
    const auto [first, last] = level.span(low, high, tolerance);
    for (std::size_t i = first > 0 ? first - 1 : 0; i < std::min(last + 1, n); ++i)
      add_face(areas[level.in_list(i)], area, {p[0].z - level[i], p[1].z - level[i], p[2].z - level[i]}, tolerance);
    if (first > 1) above[first - 1] += area;
    if (last + 1 < n) below[last] += area;
  }
  for (std::size_t i = n; i-- > 1; above[i - 1] += above[i]) areas[level.in_list(i - 1)].fill += above[i];
  for (std::size_t i = 1; i < n; below[i] += below[i - 1], ++i) areas[level.in_list(i)].cut += below[i - 1];
  return areas;
}

SpaceAreas space_areas(const Tin& surface, const Tin& reference, double tolerance, const Crs& crs,
                       const AreaScale& scale, Context& context) {
  SpaceAreas areas;
  std::array<Point, 3> p;
  std::array<double, 3> dz;
  const Overlay both = overlay(surface, reference, {}, context);
  for (Index f = 0; f < static_cast<Index>(both.faces.size()); ++f) {
    if (both.parents[f][0] == none || both.parents[f][1] == none) continue;
    for (int k = 0; k < 3; ++k) {
      const Point2 at = both.points[both.faces[f][k]];
      p[k] = {at.x, at.y, both.height(0, f, k)};
      dz[k] = p[k].z - both.height(1, f, k);
    }
    add_face(areas, area_of(p, crs, scale), dz, tolerance);
  }
  return areas;
}

}  // namespace terrane
