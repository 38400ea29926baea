// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/synthesize.hpp"
#include "core/validate.hpp"
#include "ops/operations.hpp"
#include "ops/synthesis.hpp"

namespace terrane {
namespace {

struct PolygonParameters {
  std::optional<Vectors> points;
  std::string points_crs;
  bool spline = true;
  std::optional<long> samples;
  Length z, max_edge;

  void visit(Fields& f) {
    f.vectors("points", points,
              "The corners, or the points that the curve passes, in order; a line or a ring will do.");
    f.crs("points-crs", points_crs, "The CRS of the points, where their bytes do not say it.");
    f.boolean("spline", spline,
              "Join the points by a periodic cubic spline over the square roots of their distances; without it by "
              "straight edges.");
    f.integer(
        "samples", samples, {.minimum = 3, .maximum = 1'000'000},
        "How many places of the spline are taken, the points among them where there are no more points than that. "
        "Without it 8 for each point, and 64 at least.");
    f.length("z", z, {}, "The height of the mesh.");
    f.length("max-edge", max_edge, {.minimum = 0},
             "No edge is longer in plan; 0 asks for as few faces as there can be. Metres where the CRS has degrees.");
  }
};

void check(const nlohmann::json& p, const std::vector<InputPart>&) {
  need_parameters(p, "synthesize-polygon", {"points"});
  if (p.contains("samples") && !p["samples"].is_null() && p.contains("spline") && p["spline"] == false)
    throw Error(ErrorKind::usage, "bad-parameter", "'samples' is of the spline, and spline is false");
}

/// Splines can loop between samples, which their polygon would not show.
void refuse_loops(const std::vector<Point2>& points, int samples, Context& context) {
  const std::size_t fine = std::min<std::size_t>(32 * points.size(), 2'000'000);
  if (fine <= static_cast<std::size_t>(samples)) return;
  if (const auto contact = self_contact(closed_spline(points, static_cast<int>(fine)), context))
    throw Error(ErrorKind::input, "crosses-itself",
                "the curve crosses or touches itself at " + nlohmann::json(contact->at.x).dump() + ", " +
                    nlohmann::json(contact->at.y).dump() + "; move the points around it apart, or say spline=false");
}

Outcome run(std::vector<Surface>&, const PolygonParameters& p, const Crs& crs, Context& context) {
  std::vector<Point2> points;
  for (const Point& q : p.points->points()) points.push_back(plan(q));
  for (const Point2 q : points)
    if (std::fabs(q.x) > largest_coordinate || std::fabs(q.y) > largest_coordinate)
      throw Error(ErrorKind::input, "overflow",
                  "parameter 'points': the place " + nlohmann::json(q.x).dump() + ", " + nlohmann::json(q.y).dump() +
                      " is too far away to compute with; coordinates up to 1e100 can be");
  points = without_repeats(points);
  if (points.size() < 3)
    throw Error(ErrorKind::input, "too-few-points",
                "a closed curve needs three points that differ; there are " + std::to_string(points.size()));
  if (!p.spline) return level_mesh(points, "the polygon", p.z, p.max_edge, crs, context);
  const long most = 1'000'000;
  const int samples = static_cast<int>(p.samples.value_or(std::clamp(8 * static_cast<long>(points.size()), 64L, most)));
  if (static_cast<std::size_t>(samples) < points.size())
    context.warn({"few-samples", "", "",
                  std::to_string(samples) + " samples of a curve through " + std::to_string(points.size()) +
                      " points leave most of these out",
                  "raise samples"});
  refuse_loops(points, samples, context);
  return level_mesh(closed_spline(points, samples), "the curve", p.z, p.max_edge, crs, context);
}

}  // namespace

Operation synthesize_polygon() {
  return operation<PolygonParameters>(
      {.id = "synthesize-polygon",
       .title = "Make a level free-form mesh",
       .description =
           "What a closed curve through the points encloses, level at z: a periodic cubic spline, or straight "
           "edges. A curve that crosses itself is refused with the place. crs says where it is.",
       .check = check,
       .example = {.parameters = {{"points", "0,0;400,50;350,300;50,250"}, {"z", "120"}}}},
      run);
}

}  // namespace terrane
