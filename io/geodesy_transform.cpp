// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.hpp"
#include "core/predicates.hpp"
#include "core/shortest.hpp"
#include "io/geodesy_osr.hpp"

// Moving coordinates from one CRS to another. A missing datum shift is an error, never silently nothing.
namespace terrane {

namespace {

constexpr std::size_t chunk = 65536;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool has_heights(const Crs& crs) { return crs.vertical_datum() != "unknown"; }

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : " or ") + name;
  return out;
}

/// One way from a CRS to another, decided once for a whole mesh.
class Mover {
 public:
  Mover(const Crs& from, const Crs& to, const Box& area);

  /// Moves points in place; those that cannot be become NaN. `surely`: looks whether they come back.
  void move(Point* points, std::size_t count, bool surely) const;
  /// False when planes stay planes: units change, nothing else.
  bool bends() const { return there_ != nullptr; }
  bool shifts_heights() const { return shift_heights_; }
  bool converts_height_units() const { return !shift_heights_ && height_factor_ != 1; }

 private:
  void transform_chunk(Point* points, std::size_t count, bool surely) const;

  Transformation there_, back_;  // null when the plan stays as it is
  bool keep_plan_ = false, shift_heights_ = false, from_geographic_ = false, to_geographic_ = false;
  double plan_factor_ = 1, height_factor_ = 1, metres_per_unit_ = 1;
};

/// There is a way between the two, but not where the coordinates are: mostly they are not what they are taken for.
[[noreturn]] void refuse_area(const Crs& from, const Crs& to, const Box& lon_lat) {
  const auto place = [](double lon, double lat) {
    return shortest(std::round(1e4 * lon) / 1e4) + ", " + shortest(std::round(1e4 * lat) / 1e4);
  };
  throw Error(ErrorKind::input, "outside-crs",
              "the coordinates, read as " + from.name() + ", lie between longitude, latitude " +
                  place(lon_lat.xmin, lon_lat.ymin) + " and " + place(lon_lat.xmax, lon_lat.ymax) +
                  ", where no way to " + to.name() +
                  " is known; correct them or say which coordinate reference system they are in");
}

Mover::Mover(const Crs& from, const Crs& to, const Box& area) {
  if (!from.known() || !to.known())
    throw Error(ErrorKind::usage, "no-crs",
                "a transformation needs both coordinate reference systems; give assume-crs");
  height_factor_ = from.metres_per_height_unit() / to.metres_per_height_unit();
  if (from.local() || to.local()) {
    if (!(from.local() && to.local()))
      throw Error(ErrorKind::input, "local-frame",
                  "a local frame has no place on the Earth, so it cannot be transformed to or from " +
                      (from.local() ? to : from).name() + "; give the real system with crs");
    keep_plan_ = true;
    plan_factor_ = from.metres_per_length_unit() / to.metres_per_length_unit();
    return;
  }
  keep_plan_ = from.same_plan(to);
  shift_heights_ = has_heights(from) && has_heights(to) && from.vertical_datum() != to.vertical_datum();
  if (keep_plan_ && !shift_heights_) return;
  from_geographic_ = from.geographic();
  to_geographic_ = to.geographic();
  metres_per_unit_ = from.metres_per_length_unit();
  const Quiet quiet;
  const Crs::Impl &a = from.inside(), &b = to.inside();
  const Box lon_lat = lon_lat_box(from, area);
  const auto source = osr(shift_heights_ ? a.definition : a.horizontal_definition);
  const auto target = osr(shift_heights_ ? b.definition : b.horizontal_definition);
  there_ = make_transformation(source, target, &lon_lat, false);
  if (!there_) {
    const std::vector<std::string> grids = missing_grids(from, to, lon_lat);
    if (!grids.empty())
      throw Error(ErrorKind::input, "missing-grid",
                  "the way from " + from.name() + " to " + to.name() + " needs the grid " + listed(grids) +
                      ", which is not installed; install it (package proj-data or https://cdn.proj.org) or choose "
                      "another target-crs");
    if (make_transformation(source, target, nullptr, false)) refuse_area(from, to, lon_lat);
    throw Error(ErrorKind::input, "no-transformation",
                "no transformation from " + from.name() + " to " + to.name() +
                    " is known here (it may need a grid that is not installed); choose another target-crs");
  }
  if (!keep_plan_)
    back_ = make_transformation(osr(b.horizontal_definition), osr(a.horizontal_definition), &lon_lat, false);
}

void Mover::move(Point* points, std::size_t count, bool surely) const {
  for (std::size_t first = 0; first < count; first += chunk)
    transform_chunk(points + first, std::min(chunk, count - first), surely);
}

void Mover::transform_chunk(Point* points, std::size_t count, bool surely) const {
  if (!there_) {
    for (Point* p = points; p != points + count; ++p)
      *p = {p->x * plan_factor_, p->y * plan_factor_, p->z * height_factor_};
    return;
  }
  std::vector<double> x(count), y(count), z(count, 0.0), bx, by;
  for (std::size_t k = 0; k < count; ++k) {
    x[k] = points[k].x;
    y[k] = points[k].y;
    if (shift_heights_) z[k] = points[k].z;
  }
  const Quiet quiet;
  const auto n = static_cast<int>(count);
  there_->Transform(n, x.data(), y.data(), z.data());
  surely = surely && back_;
  if (surely) {
    // Beyond what a projection can hold some formulas return numbers all the same: those do not come back.
    bx = x;
    by = y;
    back_->Transform(n, bx.data(), by.data());
  }
  for (std::size_t k = 0; k < count; ++k) {
    Point& p = points[k];
    bool good = std::isfinite(x[k]) && std::isfinite(y[k]) && std::isfinite(z[k]);
    if (good && surely) {
      const double metres = from_geographic_ ? 111'320 : metres_per_unit_;
      const double dx =
          from_geographic_ ? std::remainder(bx[k] - p.x, 360) * std::cos(p.y * std::numbers::pi / 180) : bx[k] - p.x;
      good = std::hypot(dx, by[k] - p.y) * metres < 1;
    }
    const double height = shift_heights_ ? z[k] : p.z * height_factor_;
    if (!good)
      p = {nan, nan, nan};
    else
      p = keep_plan_ ? Point{p.x, p.y, height} : Point{x[k], y[k], height};
  }
}

/// Longitudes come back within +-180; a surface that crosses the antimeridian is put together again.
void rejoin_longitudes(std::vector<Point>& vertices) {
  double low = 360, high = -360, low_east = 720, high_east = -360;
  for (const Point& p : vertices) {
    const double east = p.x < 0 ? p.x + 360 : p.x;
    low = std::min(low, p.x);
    high = std::max(high, p.x);
    low_east = std::min(low_east, east);
    high_east = std::max(high_east, east);
  }
  if (high - low <= 180 || high_east - low_east >= high - low) return;
  for (Point& p : vertices)
    if (p.x < 0) p.x += 360;
}

/// Height above (or below) the surface of an edge's midpoint: on the face when it falls on it, else against the edge.
double bend(const Point& m, const Point& a, const Point& b, const Point& c) {
  const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (area == 0) return 0;
  const double u = ((m.x - a.x) * (c.y - a.y) - (m.y - a.y) * (c.x - a.x)) / area;
  const double v = ((b.x - a.x) * (m.y - a.y) - (b.y - a.y) * (m.x - a.x)) / area;
  if (u >= 0 && v >= 0 && u + v <= 1) return std::fabs(a.z + u * (b.z - a.z) + v * (c.z - a.z) - m.z);
  const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
  const double t = length2 > 0 ? std::clamp(((m.x - a.x) * dx + (m.y - a.y) * dy) / length2, 0.0, 1.0) : 0;
  return std::fabs(a.z + t * (b.z - a.z) - m.z);
}

double measure_planarity(const Tin& before, const Tin& after, const Mover& mover, bool to_geographic,
                         Context& context) {
  double worst = 0;
  std::vector<Point> middles;
  constexpr std::size_t faces_per_chunk = chunk / 3;
  for (std::size_t first = 0; first < before.faces.size(); first += faces_per_chunk) {
    context.progress("transform", 0.5 + 0.5 * static_cast<double>(first) / static_cast<double>(before.faces.size()));
    const std::size_t last = std::min(first + faces_per_chunk, before.faces.size());
    middles.clear();
    for (std::size_t f = first; f < last; ++f)
      for (int k = 0; k < 3; ++k) {
        const Point &a = before.vertices[before.faces[f][k]], &b = before.vertices[before.faces[f][(k + 1) % 3]];
        middles.push_back({a.x + (b.x - a.x) / 2, a.y + (b.y - a.y) / 2, a.z + (b.z - a.z) / 2});
      }
    mover.move(middles.data(), middles.size(), false);
    for (std::size_t f = first; f < last; ++f)
      for (int k = 0; k < 3; ++k) {
        const Face& face = after.faces[f];
        const Point &a = after.vertices[face[k]], &b = after.vertices[face[(k + 1) % 3]],
                    &c = after.vertices[face[(k + 2) % 3]];
        Point m = middles[3 * (f - first) + k];
        if (to_geographic) m.x = a.x + std::remainder(m.x - a.x, 360);
        const double d = std::isfinite(m.x) ? bend(m, a, b, c) : 0;
        worst = std::max(worst, d);
      }
  }
  return worst;
}

Box box_of(const std::vector<Point>& points) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Box box{inf, inf, -inf, -inf};
  for (const Point& p : points) {
    box.xmin = std::min(box.xmin, p.x);
    box.ymin = std::min(box.ymin, p.y);
    box.xmax = std::max(box.xmax, p.x);
    box.ymax = std::max(box.ymax, p.y);
  }
  return box;
}

}  // namespace

Transformation make_transformation(const OGRSpatialReference& from, const OGRSpatialReference& to, const Box* lon_lat,
                                   bool ballpark) {
  OGRCoordinateTransformationOptions options;
  options.SetBallparkAllowed(ballpark);
  if (lon_lat && is_area(*lon_lat)) {
    const Box area = area_of_interest(*lon_lat);
    options.SetAreaOfInterest(area.xmin, std::max(area.ymin, -90.0), area.xmax, std::min(area.ymax, 90.0));
  }
  return Transformation(OGRCreateCoordinateTransformation(&from, &to, options));
}

Box lon_lat_box(const Crs& crs, const Box& box) {
  const bool real =
      std::isfinite(box.xmin) && std::isfinite(box.xmax) && std::isfinite(box.ymin) && std::isfinite(box.ymax);
  if (!crs.known() || crs.local() || !real) return {};
  if (crs.geographic()) return box;
  const Quiet quiet;
  const auto plane = osr(crs.inside().horizontal_definition);
  const std::unique_ptr<OGRSpatialReference> degrees(plane.CloneGeogCS());
  if (!degrees) return {};
  degrees->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const Transformation inverse = make_transformation(plane, *degrees, nullptr, true);
  if (!inverse) return {};
  std::vector<Point> rim;
  constexpr int steps = 8;
  for (int j = 0; j <= steps; ++j)
    for (int i = 0; i <= steps; ++i) {
      double x = box.xmin + (box.xmax - box.xmin) * i / steps, y = box.ymin + (box.ymax - box.ymin) * j / steps;
      if (inverse->Transform(1, &x, &y) && std::isfinite(x) && std::isfinite(y)) rim.push_back({x, y, 0});
    }
  if (rim.empty()) return {};
  rejoin_longitudes(rim);
  return box_of(rim);
}

Tin transform(const Tin& tin, const Crs& from, const Crs& to, double* planarity_error, Context& context) {
  const Mover mover(from, to, bounds(tin));
  if (mover.converts_height_units())
    context.warn(
        {"heights-converted", "", "", "heights were converted from " + from.height_unit() + " to " + to.height_unit(),
         "if they are in " + to.height_unit() + " already, say so with a compound CRS such as EPSG:25831+5773"});
  Tin out = tin;
  for (std::size_t first = 0; first < out.vertices.size(); first += chunk) {
    context.progress("transform", 0.5 * static_cast<double>(first) / static_cast<double>(out.vertices.size()));
    const std::size_t count = std::min(chunk, out.vertices.size() - first);
    mover.move(out.vertices.data() + first, count, true);
    for (std::size_t v = first; v < first + count; ++v)
      if (!std::isfinite(out.vertices[v].x))
        throw Error(ErrorKind::input, "outside-crs",
                    "vertex " + std::to_string(v) + " at " + shortest(tin.vertices[v].x) + ", " +
                        shortest(tin.vertices[v].y) + " has no place in " + to.name() +
                        (mover.shifts_heights() ? " or lies outside the grid of its heights" : "") +
                        "; choose a target-crs that covers the data");
  }
  if (to.geographic() && !from.same_plan(to)) rejoin_longitudes(out.vertices);
  if (planarity_error)
    *planarity_error = !mover.bends() ? 0 : measure_planarity(tin, out, mover, to.geographic(), context);
  return out;
}

void transform_points(std::vector<Point>& points, const Crs& from, const Crs& to) {
  Mover(from, to, box_of(points)).move(points.data(), points.size(), true);
}

}  // namespace terrane
