// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "core/topology.hpp"
#include "core/volume.hpp"

namespace terrane {
namespace {

constexpr double degree = std::numbers::pi / 180;

/// Metres per degree of longitude and of latitude on WGS 84's ellipsoid; its figures differ from any other's by 1e-5.
Point2 metres_per_degree(double latitude) {
  constexpr double a = 6378137, e2 = 0.00669437999014;
  const double s = std::sin(latitude * degree), w = std::sqrt(1 - e2 * s * s);
  return {a / w * std::cos(latitude * degree) * degree, a * (1 - e2) / (w * w * w) * degree};
}

/// Coordinates that are said to be degrees and cannot be: no figure on the ground can be made of them.
bool impossible(const Tin& tin, const Crs& crs) {
  if (!crs.known() || !crs.geographic() || tin.vertices.empty()) return false;
  const Box box = bounds(tin);
  return !(box.ymin >= -90 && box.ymax <= 90);
}

}  // namespace

Units units_of(const Crs& crs) {
  if (!crs.known()) return {"m", "m", "m2", "m3", 1, 1};
  const std::string length = crs.length_unit(), height = crs.height_unit();
  if (crs.geographic()) return {length, height, "m2", "m3", 1, crs.metres_per_height_unit()};
  if (length == height) return {length, height, length + "2", length + "3", 1, 1};
  const double metre = crs.metres_per_length_unit();
  return {length, height, "m2", "m3", metre * metre, crs.metres_per_height_unit()};
}

double domain_area(const Tin& tin, const Crs& crs, const Context& context) {
  if (impossible(tin, crs)) return std::numeric_limits<double>::quiet_NaN();
  const bool geographic = crs.known() && crs.geographic();
  return domain_area(tin, crs, geographic ? 0 : plan_area(tin, context));
}

double domain_area(const Tin& tin, const Crs& crs, double plan_area) {
  if (impossible(tin, crs)) return std::numeric_limits<double>::quiet_NaN();
  if (crs.known() && crs.geographic()) return area(tin, ellipsoidal_area_scale(crs));
  return plan_area * units_of(crs).area_factor;
}

PlanMetric plan_metric(const Crs& crs) {
  if (!crs.known() || !crs.geographic()) return {};
  return {[](double latitude) {
    const Point2 metres = metres_per_degree(std::clamp(latitude, -89.9, 89.9));
    return metres;
  }};
}

double plan_length(const Length& length, const Crs& crs) {
  return length.in(crs.known() && !crs.geographic() ? crs.metres_per_length_unit() : 1.0);
}

std::string length_unit(const Crs& crs) { return crs.known() && !crs.geographic() ? crs.length_unit() : "m"; }

double distance(Point2 a, Point2 b, const Crs& crs) {
  Point2 unit{1, 1};
  if (crs.known() && crs.geographic()) unit = metres_per_degree((a.y + b.y) / 2);
  return std::hypot((b.x - a.x) * unit.x, (b.y - a.y) * unit.y);
}

Outline outline(const Tin& tin, const Crs& crs) {
  const PlanTopology topology = plan_topology(tin);
  Outline result;
  result.edges = topology.border.size();
  if (impossible(tin, crs)) result.length = std::numeric_limits<double>::quiet_NaN();
  // Loops are followed place by place; where borders touch in a point they are taken as they come.
  std::multimap<Index, Index> leaving;
  for (Index h : topology.border) {
    const Index from = topology.from(tin, h);
    result.length += distance(plan(tin.vertices[from]), plan(tin.vertices[topology.to(tin, h)]), crs);
    leaving.emplace(topology.place[from], h);
  }
  while (!leaving.empty()) {
    ++result.loops;
    auto it = leaving.begin();
    while (it != leaving.end()) {
      const Index h = it->second;
      leaving.erase(it);
      it = leaving.find(topology.place[topology.to(tin, h)]);
    }
  }
  return result;
}

double steepness(const Point& a, const Point& b, const Point& c, const Crs& crs) {
  Point2 unit{1, 1};
  double z = 1;
  if (crs.known() && crs.geographic()) {
    unit = metres_per_degree((a.y + b.y + c.y) / 3);
    z = crs.metres_per_height_unit();
  } else if (crs.known()) {
    z = crs.metres_per_height_unit() / crs.metres_per_length_unit();
  }
  const double ux = (b.x - a.x) * unit.x, uy = (b.y - a.y) * unit.y, uz = (b.z - a.z) * z;
  const double vx = (c.x - a.x) * unit.x, vy = (c.y - a.y) * unit.y, vz = (c.z - a.z) * z;
  const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
  return nz == 0 ? 1 : std::sqrt(nx * nx + ny * ny + nz * nz) / std::fabs(nz);
}

double surface_area(const Tin& tin, const Crs& crs) {
  if (impossible(tin, crs)) return std::numeric_limits<double>::quiet_NaN();
  const bool geographic = crs.known() && crs.geographic();
  const AreaScale scale = geographic ? ellipsoidal_area_scale(crs) : AreaScale{};
  double sum = 0, lost = 0;  // compensated
  for (const Face& f : tin.faces) {
    if (is_wall(tin, f)) continue;
    const Point &a = tin.vertices[f[0]], &b = tin.vertices[f[1]], &c = tin.vertices[f[2]];
    double part = std::fabs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2 * steepness(a, b, c, crs);
    if (geographic) part *= scale((a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3);
    const double y = part - lost, t = sum + y;
    lost = (t - sum) - y;
    sum = t;
  }
  return sum * units_of(crs).area_factor;
}

}  // namespace terrane
