// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/predicates.hpp"
#include "core/triangulate.hpp"
#include "core/validate.hpp"
#include "ops/frame.hpp"
#include "ops/heights.hpp"

namespace terrane {
namespace {

/// Units of heights are converted here unless both vertical datums are known, when the geodesy does it with the shift.
double height_factor(const Crs& from, const Crs& to) {
  const bool shifted = from.vertical_datum() != "unknown" && to.vertical_datum() != "unknown" &&
                       from.vertical_datum() != to.vertical_datum();
  return shifted ? 1.0 : from.metres_per_height_unit() / to.metres_per_height_unit();
}

bool same_datum(const Crs& from, const Crs& to) {
  return from.vertical_datum() == "unknown" || to.vertical_datum() == "unknown" ||
         from.vertical_datum() == to.vertical_datum();
}

/// A sample that belongs to a triangle of the domain: one of its four cells has three samples, itself included.
bool in_domain(const Raster& dem, int i, int j) {
  const auto exists = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < dem.width && y < dem.height && !std::isnan(dem.at(x, y));
  };
  if (!exists(i, j)) return false;
  for (int di : {-1, 1})
    for (int dj : {-1, 1})
      if (exists(i + di, j) + exists(i, j + dj) + exists(i + di, j + dj) >= 2) return true;
  return false;
}

/// The samples of the domain where they come to lie. `heights_only`: the plan stays.
std::vector<Point> moved_samples(const Raster& dem, const Crs& from, const Crs& to) {
  std::vector<Point> samples;
  for (int j = 0; j < dem.height; ++j)
    for (int i = 0; i < dem.width; ++i)
      if (in_domain(dem, i, j)) {
        const Point2 p = dem.place(i, j);
        samples.push_back({p.x, p.y, dem.at(i, j)});
      }
  move_points(samples, from, to);
  return samples;
}

double largest_error(const Tin& tin, const std::vector<Point>& samples, Context& context) {
  const HeightField surface(tin);
  double worst = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i % 65536 == 0) context.progress("measure", static_cast<double>(i) / samples.size());
    const Point& p = samples[i];
    if (!std::isfinite(p.x + p.y + p.z)) continue;
    // A straight edge of the border may leave a sample of a bent one just outside; the nearest face answers for it.
    if (const auto z = surface.nearest({p.x, p.y})) worst = std::max(worst, std::fabs(*z - p.z));
  }
  return worst;
}

void refuse_turned(const Tin& tin, const std::string& name) {
  for (std::size_t f = 0; f < tin.faces.size(); ++f) {
    const Face& face = tin.faces[f];
    const Point2 a = plan(tin.vertices[face[0]]), b = plan(tin.vertices[face[1]]), c = plan(tin.vertices[face[2]]);
    if (orientation(a, b, c) < 0)
      throw Error(ErrorKind::input, "turned-over",
                  "the transformation turns face " + std::to_string(f) + " of '" + name +
                      "' over; choose a target-crs that suits its place");
  }
}

}  // namespace

bool differs(const Crs& from, const Crs& to) {
  if (!from.known() || !to.known()) return false;
  return !from.same_plan(to) || !same_datum(from, to) || height_factor(from, to) != 1;
}

void move_points(std::vector<Point>& points, const Crs& from, const Crs& to) {
  if (!differs(from, to)) return;
  const double factor = height_factor(from, to);
  if (from.local() && to.local()) {
    const double scale = from.metres_per_length_unit() / to.metres_per_length_unit();
    for (Point& p : points) p.x *= scale, p.y *= scale;
  } else if (!same_datum(from, to)) {
    transform_points(points, from, to);
  } else if (!from.same_plan(to)) {
    transform_points(points, from.horizontal(), to.horizontal());
  }
  if (factor != 1)
    for (Point& p : points) p.z *= factor;
}

void move_to(Tin& tin, const Crs& from, const Crs& to, const std::string& name, double& planarity_error,
             Context& context) {
  if (!differs(from, to)) return;
  const double factor = height_factor(from, to);
  double bend = 0;
  if (from.local() && to.local()) {
    move_points(tin.vertices, from, to);
  } else {
    if (!same_datum(from, to))
      tin = transform(tin, from, to, &bend, context);
    else if (!from.same_plan(to))
      tin = transform(tin, from.horizontal(), to.horizontal(), &bend, context);
    if (factor != 1)
      for (Point& p : tin.vertices) p.z *= factor;
  }
  if (factor != 1)
    context.warn({"heights-converted", name, "",
                  "heights were converted from " + from.height_unit() + " to " + to.height_unit(), ""});
  planarity_error = std::max(planarity_error, bend * (same_datum(from, to) ? factor : 1.0));
  refuse_turned(tin, name);
}

DemTin dem_tin(const Raster& dem, const Crs& from, const Crs& to, const std::string& name, const DemOptions& options,
               Context& context) {
  const bool moves = differs(from, to);
  const double factor = moves ? height_factor(from, to) : 1.0;
  TriangulateOptions ask{options.max_error / factor, options.max_triangles};
  std::vector<Point> samples;
  if (moves && options.max_error > 0) samples = moved_samples(dem, from, to);
  for (int round = 0;; ++round) {
    Triangulated made = triangulate(dem, ask, context);
    DemTin result;
    result.tin = checked(std::move(made.tin), name, context);
    result.error = made.error * factor;
    if (!moves) return result;
    const std::size_t warnings = context.warnings.size();
    move_to(result.tin, from, to, name, result.planarity_error, context);
    result.tin = checked(std::move(result.tin), name, context);
    if (options.max_error == 0) return result;  // every sample is a vertex and went where it goes
    result.error = largest_error(result.tin, samples, context);
    if (result.error <= options.max_error || options.max_triangles > 0) return result;
    // Straight edges bend: ask for less, and in the end for every sample.
    context.warnings.resize(warnings);
    ask.max_error *= round < 8 ? std::min(0.9, 0.98 * options.max_error / result.error) : 0.0;
  }
}

}  // namespace terrane
