// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/box.hpp"
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

/// What is longitudes and latitudes by its kind and cannot be these was meant otherwise.
void check_degrees(Vectors& vectors, const std::string& name) {
  for_each_point(vectors, [&](const Point& p) {
    if (std::fabs(p.x) > 180 || std::fabs(p.y) > 90)
      refuse(name, "not-degrees",
             std::string(vectors.geojson ? "GeoJSON holds longitudes and latitudes unless a crs member says otherwise"
                                         : "columns of this name hold longitudes and latitudes") +
                 ", and " + nlohmann::json(p.x).dump() + ", " + nlohmann::json(p.y).dump() + " is none; give " + name +
                 "-crs");
  });
}

/// Where the vectors are; unknown: in the frame.
Crs source_of(Vectors& vectors, const std::string& name, const Plan& plan, const Crs& frame) {
  if (const auto it = plan.parameters.find(name + "-crs"); it != plan.parameters.end() && it->is_string())
    return Crs::parse(it->get_ref<const std::string&>());
  if (vectors.crs.known() || !vectors.lonlat) return vectors.crs;
  check_degrees(vectors, name);
  return frame.known() && !frame.local() ? Crs::parse("OGC:CRS84") : Crs();
}

void move(Vectors& vectors, const std::string& name, const Crs& from, const Crs& to) {
  std::vector<Point> points;
  for_each_point(vectors, [&](const Point& p) { points.push_back({p.x, p.y, std::isnan(p.z) ? 0 : p.z}); });
  try {
    move_points(points, from, to);
  } catch (const Error& error) {
    refuse(name, error.code, error.what());
  }
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

/// The whole turns by which longitudes from `low` to `high` come to lie over the surfaces. Several are rare: a region
/// that goes round the globe, a surface beyond 180 degrees. None needed, or of no use: 0.
std::vector<double> turns_over(const Box& surfaces, double low, double high) {
  if (!(low >= -720 && high <= 720)) return {0};  // no longitudes
  const double first = std::ceil((surfaces.xmin - high) / 360), last = std::floor((surfaces.xmax - low) / 360);
  std::vector<double> turns;
  for (double k = first; k <= last && k < first + 4; ++k)
    if (360 * k + high > surfaces.xmin && 360 * k + low < surfaces.xmax) turns.push_back(360 * k);
  if (turns.empty()) turns.push_back(first <= last && !(first <= 0 && 0 <= last) ? 360 * first : 0);  // at their rim
  return turns;
}

void turn(std::vector<Point>& points, double by) {
  for (Point& p : points) p.x += by;
}
void turn(Point& p, double by) { p.x += by; }
void turn(Polygon& polygon, double by) {
  turn(polygon.outer, by);
  for (Line& hole : polygon.holes) turn(hole, by);
}

Box reach_of(const std::vector<Point>& points) {
  Box box = no_box;
  for (const Point& p : points) box = around(box, plan(p));
  return box;
}
Box reach_of(const Point& p) { return around(no_box, plan(p)); }
Box reach_of(const Polygon& polygon) { return reach_of(polygon.outer); }

/// Points and lines stay one each.
template <class Shape>
void lay_over(std::vector<Shape>& shapes, const Box& surfaces) {
  for (Shape& shape : shapes) {
    const Box box = reach_of(shape);
    const std::vector<double> turns = turns_over(surfaces, box.xmin, box.xmax);
    if (std::find(turns.begin(), turns.end(), 0) == turns.end()) turn(shape, turns.front());
  }
}

/// An area is laid wherever it covers some of the surfaces.
void lay_over(std::vector<Polygon>& polygons, const Box& surfaces) {
  std::vector<Polygon> laid;
  for (const Polygon& polygon : polygons) {
    const Box box = reach_of(polygon);
    for (const double by : turns_over(surfaces, box.xmin, box.xmax)) {
      laid.push_back(polygon);
      if (by != 0) turn(laid.back(), by);
    }
  }
  polygons = std::move(laid);
}

/// In longitudes 181 is -179.
void lay_over(Vectors& vectors, const std::vector<Surface>& surfaces) {
  Box box = no_box;
  for (const Surface& s : surfaces)
    if (!s.level()) box = around(box, box_of(s));
  if (!(box.xmin <= box.xmax)) return;
  for (Feature& f : vectors.features) {
    lay_over(f.points, box);
    lay_over(f.lines, box);
    lay_over(f.polygons, box);
  }
}

}  // namespace

std::map<std::string, Vectors> vectors_in_frame(const Plan& plan, const std::vector<Surface>& surfaces,
                                                const Crs& frame, Context& context) {
  std::map<std::string, Vectors> all;
  for (const auto& [name, bytes] : plan.vectors) {
    Vectors vectors = read_vectors(bytes, "parameter '" + name + "'", context);
    const Crs from = source_of(vectors, name, plan, frame);
    if (from.known() && !from.local() && !(frame.known() && !frame.local()))
      refuse(name, "missing-crs",
             "it is in " + from.name() + ", and no input says where it is; give crs or assume-crs");
    if (from.known() && frame.known() && differs(from, frame)) move(vectors, name, from, frame);
    if (frame.known() && frame.geographic()) lay_over(vectors, surfaces);
    vectors.crs = frame;
    all.emplace(name, std::move(vectors));
  }
  return all;
}

}  // namespace terrane
