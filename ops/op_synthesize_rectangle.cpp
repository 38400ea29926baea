// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/synthesize.hpp"
#include "ops/operations.hpp"
#include "ops/synthesis.hpp"

namespace terrane {
namespace {

struct RectangleParameters {
  std::optional<double> xmin, ymin, xmax, ymax;
  Length zmin, max_edge;
  std::optional<Length> zmax;

  void visit(Fields& f) {
    f.number("xmin", xmin, {}, "CRS units", "The left side.");
    f.number("ymin", ymin, {}, "CRS units", "The lower side.");
    f.number("xmax", xmax, {}, "CRS units", "The right side.");
    f.number("ymax", ymax, {}, "CRS units", "The upper side.");
    f.length("zmin", zmin, {}, "The height along the left side.");
    f.length("zmax", zmax, {}, "The height along the right side; without it the rectangle is level at zmin.");
    f.length("max-edge", max_edge, {.minimum = 0},
             "No edge is longer in plan; 0 asks for two faces. Metres where the CRS has degrees.");
  }
};

void check(const nlohmann::json& p, const std::vector<InputPart>&) {
  need_parameters(p, "synthesize-rectangle", {"xmin", "ymin", "xmax", "ymax"});
  for (const char* axis : {"x", "y"})
    if (const std::string low = axis + std::string("min"), high = axis + std::string("max");
        !(p[low].get<double>() < p[high].get<double>()))
      throw Error(ErrorKind::usage, "bad-parameter", "parameter '" + low + "' must be below '" + high + "'");
}

Outcome run(std::vector<Surface>&, const RectangleParameters& p, const Crs& crs, Context&) {
  const double metres = crs.known() ? crs.metres_per_height_unit() : 1;
  const double left = p.zmin.in(metres);
  Outcome outcome;
  outcome.result = rectangle({*p.xmin, *p.ymin, *p.xmax, *p.ymax}, left, p.zmax ? p.zmax->in(metres) : left,
                             longest_edge(p.max_edge, crs));
  outcome.expected_area = (*p.xmax - *p.xmin) * (*p.ymax - *p.ymin);
  return outcome;
}

}  // namespace

Operation synthesize_rectangle() {
  return operation<RectangleParameters>(
      {.id = "synthesize-rectangle",
       .title = "Make a plane or a ramp over a rectangle",
       .description = "A rectangle at height zmin along its left side and zmax along its right one, linear between: a "
                      "level plane where they are equal, else a ramp. Nothing is read; crs says where it is.",
       .check = check,
       .example =
           {.parameters =
                {{"xmin", "0"}, {"ymin", "0"}, {"xmax", "400"}, {"ymax", "250"}, {"zmin", "100"}, {"zmax", "160"}}}},
      run);
}

}  // namespace terrane
