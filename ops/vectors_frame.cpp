// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/box.hpp"
#include "core/error.hpp"
#include "ops/frame.hpp"

namespace terrane {
namespace {

/// `Of`: Vectors, or const.
template <class Of, class Visit>
void for_each_point(Of& vectors, const Visit& visit) {
  const auto all = [&](auto& points) {
    for (auto& p : points) visit(p);
  };
  for (auto& f : vectors.features) {
    all(f.points);
    for (auto& line : f.lines) all(line);
    for (auto& polygon : f.polygons) {
      all(polygon.outer);
      for (auto& hole : polygon.holes) all(hole);
    }
  }
}

/// visit(p, q, i, j) for every edge: its ends, and their numbers among the points as for_each_point visits them.
template <class Visit>
void for_each_edge(const Vectors& vectors, const Visit& visit) {
  std::size_t first = 0;
  const auto along = [&](const Line& line, bool closed) {
    for (std::size_t i = closed ? 0 : 1; i < line.size(); ++i) {
      const std::size_t before = (i == 0 ? line.size() : i) - 1;
      visit(line[before], line[i], first + before, first + i);
    }
    first += line.size();
  };
  for (const Feature& f : vectors.features) {
    first += f.points.size();
    for (const Line& line : f.lines) along(line, false);
    for (const Polygon& polygon : f.polygons) {
      along(polygon.outer, true);
      for (const Line& hole : polygon.holes) along(hole, true);
    }
  }
}

[[noreturn]] void refuse(const std::string& name, std::string code, const std::string& what) {
  throw Error(ErrorKind::input, std::move(code), "parameter '" + name + "': " + what);
}

std::string text(const Point& p) { return nlohmann::json(p.x).dump() + ", " + nlohmann::json(p.y).dump(); }

/// What is longitudes and latitudes by its kind and cannot be these was meant otherwise.
void check_degrees(Vectors& vectors, const std::string& name) {
  for_each_point(vectors, [&](const Point& p) {
    if (std::fabs(p.x) > 180 || std::fabs(p.y) > 90)
      refuse(name, "not-degrees",
             std::string(vectors.geojson ? "GeoJSON holds longitudes and latitudes unless a crs member says otherwise"
                                         : "columns of this name hold longitudes and latitudes") +
                 ", and " + text(p) + " is none; give " + name + "-crs");
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

/// All points of the vectors, in `to`.
std::vector<Point> moved(const Vectors& vectors, const std::string& name, const Crs& from, const Crs& to) {
  std::vector<Point> points;
  for_each_point(vectors, [&](const Point& p) { points.push_back({p.x, p.y, std::isnan(p.z) ? 0 : p.z}); });
  try {
    move_points(points, from, to);
  } catch (const Error& error) {
    refuse(name, error.code, error.what());
  }
  return points;
}

/// Every map of the globe ends somewhere, and what crosses the line where it does is torn apart: the middle of an edge
/// is then nowhere near the middle between its ends. The first such edge.
std::optional<std::array<Point, 2>> torn(const Vectors& vectors, const std::vector<Point>& moved, const Crs& from,
                                         const Crs& to) {
  const double long_edge = 400'000 / to.metres_per_length_unit();
  std::vector<std::array<Point, 2>> edges, ends;  // as they were, as they are
  std::vector<Point> middles;
  for_each_edge(vectors, [&](const Point& p, const Point& q, std::size_t i, std::size_t j) {
    if (!(std::hypot(moved[j].x - moved[i].x, moved[j].y - moved[i].y) > long_edge)) return;
    edges.push_back({p, q});
    ends.push_back({moved[i], moved[j]});
    middles.push_back({p.x + (q.x - p.x) / 2, p.y + (q.y - p.y) / 2, 0});
  });
  move_points(middles, from, to);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto& [a, b] = ends[e];
    const double off = std::hypot(middles[e].x - (a.x + b.x) / 2, middles[e].y - (a.y + b.y) / 2);
    if (off > 0.45 * std::hypot(b.x - a.x, b.y - a.y)) return edges[e];
  }
  return {};
}

/// `counted`: the vectors with other whole turns in their longitudes, which are taken where they stay in one piece.
void move(Vectors& vectors, const Vectors& counted, const std::string& name, const Crs& from, const Crs& to) {
  std::vector<Point> points = moved(counted, name, from, to);
  if (from.geographic() && !to.geographic() && torn(counted, points, from, to)) {
    points = moved(vectors, name, from, to);
    if (const auto edge = torn(vectors, points, from, to))
      refuse(name, "outside-crs",
             "between " + text(edge->front()) + " and " + text(edge->back()) + " it crosses the line where " +
                 to.name() + " ends; cut it there, or give it in that CRS");
  }
  auto place = points.begin();
  for_each_point(vectors, [&](Point& p) {
    if (!std::isfinite(place->x) || !std::isfinite(place->y))
      refuse(name, "outside-crs",
             text(p) + " in " + from.name() + " has no place in the CRS of the result, " + to.name());
    p = {place->x, place->y, std::isnan(p.z) ? p.z : place->z};
    ++place;
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

Box box_of_all(const std::vector<Surface>& surfaces) {
  Box box = no_box;
  for (const Surface& s : surfaces)
    if (!s.level()) box = around(box, box_of(s));
  return box;
}

bool corners_alone(const Operation& operation, const std::string& name) {
  return std::any_of(operation.parameters.begin(), operation.parameters.end(),
                     [&](const Parameter& p) { return p.name == name && p.corners_alone; });
}

void take_corners(Vectors& vectors) {
  for (Feature& feature : vectors.features) {
    Vectors one;
    one.features.push_back(std::move(feature));
    feature = {std::move(one.features.front().properties), one.points()};
  }
}

/// In longitudes 181 is -179.
void lay_over(Vectors& vectors, const std::vector<Surface>& surfaces) {
  const Box box = box_of_all(surfaces);
  if (!(box.xmin <= box.xmax)) return;
  for (Feature& f : vectors.features) {
    lay_over(f.points, box);
    lay_over(f.lines, box);
    lay_over(f.polygons, box);
  }
}

/// Whoever writes an edge of more than half a turn mostly means the rest of it.
void warn_of_the_long_way(const Vectors& vectors, const std::string& name, Context& context) {
  bool warned = false;
  for_each_edge(vectors, [&](const Point& p, const Point& q, std::size_t, std::size_t) {
    const double turn = std::fabs(q.x - p.x);
    if (warned || !(turn > 180 && turn < 360)) return;
    warned = true;
    context.warn({"long-way-round", "", "",
                  "parameter '" + name + "': the edge from " + text(p) + " to " + text(q) +
                      " goes the long way round the globe, as it is written",
                  "cut it at 180 degrees if it is to cross them"});
  });
}

/// Longitudes as they are counted at the surfaces: what is cut at 180 and -180 would be one thing but for rounding once
/// it is projected.
Vectors counted_at(const std::vector<Surface>& surfaces, const Crs& frame, const Crs& from, Vectors vectors) {
  const Box all = box_of_all(surfaces);
  if (!(all.xmin <= all.xmax)) return vectors;
  std::vector<Point> centre = {{(all.xmin + all.xmax) / 2, (all.ymin + all.ymax) / 2, 0}};
  try {
    transform_points(centre, frame.horizontal(), from.horizontal());
  } catch (const Error&) {
    return vectors;  // the way here will say why there is none
  }
  const auto count = [&](auto& shapes) {
    for (auto& shape : shapes) {
      const Box box = reach_of(shape);
      const double by = -360 * std::round(((box.xmin + box.xmax) / 2 - centre[0].x) / 360);
      if (std::fabs(by) <= 720) turn(shape, by);
    }
  };
  for (Feature& f : vectors.features) count(f.points), count(f.lines), count(f.polygons);
  return vectors;
}

}  // namespace

std::map<std::string, Vectors> vectors_in_frame(const Plan& plan, const std::vector<Surface>& surfaces,
                                                const Crs& frame, Context& context) {
  std::map<std::string, Vectors> all;
  for (const auto& [name, bytes] : plan.vectors) {
    Vectors vectors = read_vectors(bytes, "parameter '" + name + "'", context);
    if (corners_alone(*plan.operation, name)) take_corners(vectors);
    const Crs from = source_of(vectors, name, plan, frame);
    if (from.known() && !from.local() && !(frame.known() && !frame.local()))
      refuse(name, "missing-crs",
             "it is in " + from.name() + ", and no input says where it is; give crs or assume-crs");
    if (from.known() && frame.known() && differs(from, frame)) {
      const bool projected = from.geographic() && !frame.geographic();
      move(vectors, projected ? counted_at(surfaces, frame, from, vectors) : vectors, name, from, frame);
    }
    if (frame.known() && frame.geographic()) {
      warn_of_the_long_way(vectors, name, context);
      lay_over(vectors, surfaces);
    }
    vectors.crs = frame;
    all.emplace(name, std::move(vectors));
  }
  return all;
}

}  // namespace terrane
