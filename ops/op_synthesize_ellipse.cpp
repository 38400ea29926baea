// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "core/synthesize.hpp"
#include "ops/operations.hpp"
#include "ops/synthesis.hpp"

namespace terrane {
namespace {

/// What circles and ellipses have in common.
struct RoundParameters {
  std::vector<double> center;
  Length z, max_edge;
  long samples = 64;

  void visit_center(Fields& f) { f.numbers("center", center, "The centre: x,y in the CRS."); }
  void visit_rest(Fields& f) {
    f.length("z", z, {}, "The height of the disc.");
    f.integer("samples", samples, {.minimum = 3, .maximum = 1'000'000},
              "How many corners the outline has, evenly spread; at least 15 are advised.");
    f.length("max-edge", max_edge, {.minimum = 0},
             "No edge is longer in plan; 0 asks for as few faces as there can be. Metres where the CRS has degrees.");
  }
};

struct CircleParameters : RoundParameters {
  std::optional<Length> radius;

  void visit(Fields& f) {
    visit_center(f);
    f.length("radius", radius, {.minimum = 0}, "The radius. Metres where the CRS has degrees.");
    visit_rest(f);
  }
};

struct EllipseParameters : RoundParameters {
  std::optional<Length> major, minor;
  double azimuth = 0;

  void visit(Fields& f) {
    visit_center(f);
    f.length("major-axis", major, {.minimum = 0},
             "The full length of the longer axis. Metres where the CRS has degrees.");
    f.length("minor-axis", minor, {.minimum = 0},
             "The full length of the shorter axis. Metres where the CRS has degrees.");
    f.number("azimuth", azimuth, {}, "degrees",
             "How far the ellipse is turned clockwise: at 0 the longer axis lies along x, at 90 along y.");
    visit_rest(f);
  }
};

void check_center(const nlohmann::json& p) {
  if (p["center"].size() != 2)
    throw Error(ErrorKind::usage, "bad-parameter", "parameter 'center' takes two numbers: x,y");
}

void check_length(const nlohmann::json& p, const char* name) {
  if (!(Length::of(p[name]).value > 0))
    throw Error(ErrorKind::usage, "bad-parameter", "parameter '" + std::string(name) + "' must be above 0");
}

void check_circle(const nlohmann::json& p, const std::vector<InputPart>&) {
  need_parameters(p, "synthesize-circle", {"center", "radius"});
  check_center(p);
  check_length(p, "radius");
}

void check_ellipse(const nlohmann::json& p, const std::vector<InputPart>&) {
  need_parameters(p, "synthesize-ellipse", {"center", "major-axis", "minor-axis"});
  check_center(p);
  check_length(p, "major-axis");
  check_length(p, "minor-axis");
  if (Length::of(p["minor-axis"]).in(1) > Length::of(p["major-axis"]).in(1) &&
      Length::of(p["minor-axis"]).unit == Length::of(p["major-axis"]).unit)
    throw Error(ErrorKind::usage, "bad-parameter",
                "parameter 'minor-axis' is longer than 'major-axis'; exchange them and turn the azimuth by 90");
}

/// Corners in the CRS. Where it has degrees the ellipse is one of metres around the centre, along geodesics.
std::vector<Point2> outline(const RoundParameters& p, const Length& major, const Length& minor, double azimuth,
                            const Crs& crs) {
  const Point2 centre{p.center[0], p.center[1]};
  const int samples = static_cast<int>(p.samples);
  if (!crs.known() || !crs.geographic()) {
    const double metres = crs.known() ? crs.metres_per_length_unit() : 1;
    return ellipse(centre, major.in(metres), minor.in(metres), azimuth, samples);
  }
  return places_around(crs, centre, ellipse({0, 0}, major.in(1), minor.in(1), azimuth, samples));
}

Outcome disc(const RoundParameters& p, const Length& major, const Length& minor, double azimuth, const Crs& crs,
             Context& context) {
  if (p.samples < 15)
    context.warn({"few-samples", "", "",
                  "an outline of " + std::to_string(p.samples) + " corners is far from round: at least 15 are advised",
                  "raise samples"});
  const std::vector<Point2> ring = outline(p, major, minor, azimuth, crs);
  for (const Point2 q : ring)
    if (!std::isfinite(q.x) || !std::isfinite(q.y))
      throw Error(ErrorKind::usage, "bad-parameter", "the outline has corners beyond what numbers can hold");
  return level_mesh(ring, "the outline", p.z, p.max_edge, crs, context);
}

Outcome run_circle(std::vector<Surface>&, const CircleParameters& p, const Crs& crs, Context& context) {
  const Length diameter{2 * p.radius->value, p.radius->unit};
  return disc(p, diameter, diameter, 0, crs, context);
}

Outcome run_ellipse(std::vector<Surface>&, const EllipseParameters& p, const Crs& crs, Context& context) {
  return disc(p, *p.major, *p.minor, p.azimuth, crs, context);
}

}  // namespace

Operation synthesize_circle() {
  return operation<CircleParameters>(
      {.id = "synthesize-circle",
       .title = "Make a level disc",
       .description = "A circle around a centre, level at z: a polygon of corners on the circle, the first at its "
                      "eastern end, triangulated. Nothing is read; crs says where it is.",
       .check = check_circle,
       .example = {.parameters = {{"center", "200,200"}, {"radius", "150"}, {"z", "120"}}}},
      run_circle);
}

Operation synthesize_ellipse() {
  return operation<EllipseParameters>(
      {.id = "synthesize-ellipse",
       .title = "Make a level ellipse",
       .description = "An ellipse around a centre, level at z: a polygon of corners evenly spread over its parameter, the "
                      "first at the end of the longer axis, triangulated. Axes are full lengths, the longer one along x "
                      "unless azimuth turns it. Nothing is read; crs says where it is.",
       .check = check_ellipse,
       .example = {.parameters = {{"center", "200,200"}, {"major-axis", "360"}, {"minor-axis", "180"}, {"z", "120"}}}},
      run_ellipse);
}

}  // namespace terrane
