// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "core/error.hpp"
#include "ops/frame.hpp"

namespace terrane {
namespace {

template <class Visit>
void for_each_point(Vectors& vectors, const Visit& visit) {
  const auto all = [&](std::vector<Point>& points) {
    for (Point& p : points) visit(p);
  };
  for (Feature& f : vectors.features) {
    all(f.points);
    for (Line& line : f.lines) all(line);
    for (Polygon& polygon : f.polygons) {
      all(polygon.outer);
      for (Line& hole : polygon.holes) all(hole);
    }
  }
}

[[noreturn]] void refuse(const std::string& name, std::string code, const std::string& what) {
  throw Error(ErrorKind::input, std::move(code), "parameter '" + name + "': " + what);
}

/// GeoJSON without a CRS means longitudes and latitudes; what cannot be these was meant otherwise.
void check_degrees(Vectors& vectors, const std::string& name) {
  for_each_point(vectors, [&](const Point& p) {
    if (std::fabs(p.x) > 180 || std::fabs(p.y) > 90)
      refuse(name, "not-degrees",
             "GeoJSON holds longitudes and latitudes unless a crs member says otherwise, and " +
                 nlohmann::json(p.x).dump() + ", " + nlohmann::json(p.y).dump() + " is none; give " + name + "-crs");
  });
}

/// Where the vectors are; unknown: in the frame.
Crs source_of(Vectors& vectors, const std::string& name, const Plan& plan, const Crs& frame) {
  if (const auto it = plan.parameters.find(name + "-crs"); it != plan.parameters.end() && it->is_string())
    return Crs::parse(it->get_ref<const std::string&>());
  if (vectors.crs.known() || !vectors.geojson) return vectors.crs;
  check_degrees(vectors, name);
  return frame.known() && !frame.local() ? Crs::parse("OGC:CRS84") : Crs();
}

void move(Vectors& vectors, const std::string& name, const Crs& from, const Crs& to) {
  std::vector<Point> points;
  for_each_point(vectors, [&](const Point& p) { points.push_back({p.x, p.y, std::isnan(p.z) ? 0 : p.z}); });
  move_points(points, from, to);
  auto moved = points.begin();
  for_each_point(vectors, [&](Point& p) {
    if (!std::isfinite(moved->x) || !std::isfinite(moved->y))
      refuse(name, "outside-crs",
             nlohmann::json(p.x).dump() + ", " + nlohmann::json(p.y).dump() + " in " + from.name() +
                 " has no place in the CRS of the result, " + to.name());
    p = {moved->x, moved->y, std::isnan(p.z) ? p.z : moved->z};
    ++moved;
  });
}

}  // namespace

std::map<std::string, Vectors> vectors_in_frame(const Plan& plan, const Crs& frame, Context& context) {
  std::map<std::string, Vectors> all;
  for (const auto& [name, bytes] : plan.vectors) {
    Vectors vectors = read_vectors(bytes, "parameter '" + name + "'", context);
    const Crs from = source_of(vectors, name, plan, frame);
    if (from.known() && !from.local() && !(frame.known() && !frame.local()))
      refuse(name, "missing-crs",
             "it is in " + from.name() + ", and no input says where it is; give crs or assume-crs");
    if (from.known() && frame.known() && differs(from, frame)) move(vectors, name, from, frame);
    vectors.crs = frame;
    all.emplace(name, std::move(vectors));
  }
  return all;
}

}  // namespace terrane
