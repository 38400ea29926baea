// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "core/clip.hpp"
#include "core/error.hpp"
#include "core/simplify.hpp"
#include "core/triangulate_points.hpp"
#include "ops/inputs.hpp"
#include "ops/measure.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"
#include "ops/region.hpp"

namespace terrane {
namespace {

enum class Duplicates { refuse, mean };

struct TriangulateParameters {
  std::optional<long> max_triangles;
  std::optional<Vectors> breaklines, boundary;
  std::string breaklines_crs, boundary_crs, columns;
  Length max_edge, max_error;
  Duplicates duplicates = Duplicates::refuse;
  std::vector<double> classes = {2};

  void visit(Fields& f) {
    f.length(
        "max-error", max_error, {.minimum = 0},
        "How far (vertically) the TIN may lie from any sample of a raster, in the result's CRS, or anywhere from the "
        "surface through all points; 0 makes every one a vertex.");
    f.integer("max-triangles", max_triangles, {.minimum = 2, .maximum = 1e9},
              "Stop at about that many faces, even if max-error is not reached; the error reached is reported.");
    f.vectors(
        "breaklines", breaklines,
        "With points: lines whose every segment becomes an edge, or a row of edges. Their corners have heights, or "
        "lie on points.");
    f.crs("breaklines-crs", breaklines_crs, "The CRS of the breaklines, where they do not say it.");
    f.vectors("boundary", boundary, "With points: polygons outside of which no surface is made.");
    f.crs("boundary-crs", boundary_crs, "The CRS of the boundary, where it does not say it.");
    f.length("max-edge", max_edge, {.minimum = 0},
             "With points: faces with a longer edge are taken away from the border inwards; 0 keeps all.");
    f.choice("duplicates", duplicates, {{"refuse", Duplicates::refuse}, {"mean", Duplicates::mean}},
             "With points: what becomes of heights that differ at one place, or where breaklines cross: refused by "
             "name, or replaced by their mean.");
    f.numbers("classes", classes, "Of LAS points the classes that are taken; 2 is ground.");
    f.text("columns", columns,
           "Of point tables the columns, a letter each: XYZ, ENZ, PNEZD (P a name, N the northing, E the easting, D "
           "words). Left out: what the first line says, else x, y, z.");
  }
};

void check(const nlohmann::json& values, const std::vector<InputPart>& inputs) {
  if (inputs.size() != 1)
    throw Error(ErrorKind::usage, inputs.empty() ? "missing-input" : "surplus-input",
                "'triangulate' takes one input, a raster ('dem') or points ('points')");
  for (const double code : filled<TriangulateParameters>(values).classes)
    if (code < 0 || code > 255 || code != std::floor(code))
      throw Error(ErrorKind::usage, "bad-parameter", "parameter 'classes' takes whole numbers from 0 to 255");
}

void refuse_point_parameters(const TriangulateParameters& p) {
  const TriangulateParameters unsaid;
  if (p.breaklines || p.boundary || p.max_edge.value > 0 || p.duplicates != unsaid.duplicates ||
      p.classes != unsaid.classes || p.columns != unsaid.columns)
    throw Error(ErrorKind::usage, "surplus-parameter",
                "breaklines, boundary, max-edge, duplicates, classes and columns are for points; the input is a raster "
                "(clip cuts its TIN)");
}

/// Leaves points out as far as max-error and max-triangles ask for it.
void thin_out(Tin& tin, const TriangulateParameters& p, const Crs& crs, Outcome& outcome, Context& context) {
  if (p.max_error.value == 0 && !p.max_triangles) return;
  SimplifyOptions options{.keep_boundary = false};
  if (p.max_error.value > 0) options.max_error = p.max_error.in(crs.known() ? crs.metres_per_height_unit() : 1.0);
  if (p.max_triangles) options.max_triangles = *p.max_triangles;
  Simplified made = simplify_and_verify(tin, options, context);
  outcome.approximation = {
      {"max_error", std::isfinite(options.max_error) ? nlohmann::json(options.max_error) : nlohmann::json()},
      {"measured", made.error},
      {"against", "the surface through all points, at every vertex and wherever edges cross"}};
  tin = std::move(made.tin);
}

Outcome from_points(Surface& surface, const TriangulateParameters& p, Context& context) {
  const Crs& crs = surface.crs;
  SurveyOptions options;
  options.average = p.duplicates == Duplicates::mean;
  options.max_edge = plan_length(p.max_edge, crs);
  if (crs.known() && crs.geographic()) options.length = [&](Point2 a, Point2 b) { return distance(a, b, crs); };
  auto& points = std::get<PointCloud>(surface.value).points;
  const std::size_t given = points.size();
  Survey survey = triangulate_points(std::move(points), p.breaklines ? p.breaklines->lines() : std::vector<Line>{},
                                     options, context);
  const auto warn = [&](const char* code, std::size_t count, const std::string& what) {
    if (count > 0) context.warn({code, surface.name, "", std::to_string(count) + " " + what, ""});
  };
  warn("duplicate-points", survey.duplicates, "points lay at the place of another and were left out");
  warn("heights-averaged", survey.averaged, "places had different heights, which were replaced by their mean");
  warn("points-left-out", survey.left_out, "points are in no face that max-edge leaves");
  Outcome outcome;
  if (p.boundary) {
    Clipped inside = clip(survey.tin, area_of(*p.boundary, "boundary", context), Side::inside, context);
    if (inside.tin.faces.empty())
      throw Error(ErrorKind::input, "no-overlap", "no face lies inside the boundary; check its CRS");
    survey.tin = std::move(inside.tin);
    outcome.rounding = inside.rounding;
  }
  thin_out(survey.tin, p, crs, outcome, context);
  outcome.certificate["points"] = {{"read", given},
                                   {"duplicates", survey.duplicates},
                                   {"averaged", survey.averaged},
                                   {"breakline_crossings", survey.crossings},
                                   {"left_out", survey.left_out}};
  outcome.result = std::move(survey.tin);
  return outcome;
}

/// Of a raster the common frame has made a TIN, within max-error in the result's CRS; nothing is left to do.
Outcome run(std::vector<Surface>& inputs, const TriangulateParameters& p, Context& context) {
  Surface& surface = inputs.front();
  if (surface.points()) return from_points(surface, p, context);
  refuse_point_parameters(p);
  Outcome outcome;
  outcome.result = std::move(std::get<Tin>(surface.value));
  return outcome;
}

}  // namespace

Operation triangulate_operation() {
  return operation<TriangulateParameters>(
      {.id = "triangulate",
       .title = "Triangulate a raster or points",
       .description = "Of a raster a TIN that is nowhere further (vertically) than max-error from its samples; voids "
                      "become holes. Of points their Delaunay triangulation, in which breaklines are edges.",
       .inputs = {{"dem", 0, 1, false, "The raster: GeoTIFF, HGT or ASCII grid; or points."},
                  {"points", 0, 1, false, "The points: a table (XYZ, CSV), or LAS."}},
       .intake = {.raster_only = true, .points_allowed = true},
       .check = check,
       .example = {.files = {"west.tif"}, .parameters = {{"max-error", "0.5"}}}},
      run);
}

}  // namespace terrane
