// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/area_quantile.hpp"
#include "core/map_sheet.hpp"
#include "ops/inputs.hpp"
#include "ops/measure.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"

namespace terrane {
namespace {

enum class Shading { hillshade, elevation, diverging };

struct RenderParameters {
  long size = 1024;
  Shading shading = Shading::hillshade;
  bool wireframe = false, legend = true;

  void visit(Fields& f) {
    f.integer("size", size, {.minimum = 16, .maximum = 8192}, "Pixels along the longer side of the picture.");
    f.choice("shading", shading,
             {{"hillshade", Shading::hillshade}, {"elevation", Shading::elevation}, {"diverging", Shading::diverging}},
             "How heights are shown: by light and shadow; by colours from low to high, with the sea below 0; or, for "
             "differences, white at 0, red below it (cut) and blue above it (fill).");
    f.boolean("wireframe", wireframe, "Draw the edges of the faces over it.");
    f.boolean("legend", legend,
              "Put a colour bar and a scale bar beside elevation and diverging pictures of at least 200 pixels.");
  }
};

/// How steep and how wide things are in the CRS's units.
void scale_to_ground(const Tin& tin, const Crs& crs, ShadeOptions& options, SheetOptions& sheet) {
  sheet.ground_per_unit = 1;
  if (!crs.known()) return;
  sheet.ground_unit = crs.length_unit();
  if (!crs.geographic()) {
    options.z_factor = crs.metres_per_length_unit() / crs.metres_per_height_unit();
    return;
  }
  const Box box = bounds(tin);
  const double latitude = std::clamp((box.ymin + box.ymax) / 2, -89.0, 89.0);
  options.x_factor = std::max(0.01, std::cos(latitude * std::numbers::pi / 180));
  options.z_factor =
      distance({box.xmin, latitude - 0.5}, {box.xmin, latitude + 0.5}, crs) / crs.metres_per_height_unit();
  sheet.ground_per_unit = distance({box.xmin, latitude}, {box.xmin + 1, latitude}, crs);
  sheet.ground_unit = "m";
}

/// A round number that is not below a positive one.
double round_up(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double digit : {1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (digit * power >= value * (1 - 1e-9)) return digit * power;
  return 10 * power;
}

/// Where colours end: a few extremes must not leave all the rest pale, so 1 % of the area may lie beyond.
double colour_limit(const Tin& tin, double largest) {
  if (!(largest > 0)) return 1;
  std::vector<LinearPiece> pieces;
  for (const Face& f : tin.faces) {
    const Point &a = tin.vertices[f[0]], &b = tin.vertices[f[1]], &c = tin.vertices[f[2]];
    const double area = ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
    if (area > 0) pieces.push_back({area, {a.z, b.z, c.z}});
  }
  const double most = pieces.empty() ? 0 : area_quantile_abs(pieces, 0, 0.99);
  return round_up(most > 0.5 * largest || !(most > 0) ? largest : most);
}

void choose_colours(const Tin& tin, Shading shading, const std::string& unit, ShadeOptions& options,
                    SheetOptions& sheet) {
  const HeightSpan span = height_span(tin);
  const std::string in_unit = unit.empty() ? "" : " (" + unit + ")";
  if (shading == Shading::elevation) {
    sheet.title = "Height" + in_unit;
    sheet.low = span.low, sheet.high = span.high;
    options.colours = elevation_colours(span.low, span.high);
    options.relief = 0.55;
    return;
  }
  const double limit = colour_limit(tin, std::max(std::fabs(span.low), std::fabs(span.high)));
  sheet.title = "Difference" + in_unit;
  sheet.low = -limit, sheet.high = limit;
  sheet.beyond_low = span.low<-limit, sheet.beyond_high = span.high> limit;
  sheet.signs = true;
  options.colours = diverging_colours(limit);
  options.relief = 0;
}

Outcome run(std::vector<Surface>& inputs, const RenderParameters& p, Context& context) {
  const Surface& surface = input(inputs, "surface");
  ShadeOptions options;
  SheetOptions sheet;
  options.size = static_cast<int>(p.size);
  options.wireframe = p.wireframe;
  scale_to_ground(surface.tin(), surface.crs, options, sheet);
  Outcome outcome;
  if (p.shading == Shading::hillshade) {
    outcome.result = hillshade(surface.tin(), options, context);
    return outcome;
  }
  choose_colours(surface.tin(), p.shading, surface.crs.known() ? surface.crs.height_unit() : "", options, sheet);
  outcome.result =
      p.legend ? map_sheet(surface.tin(), options, sheet, context) : hillshade(surface.tin(), options, context);
  return outcome;
}

}  // namespace

Operation render() {
  return operation<RenderParameters>(
      {.id = "render",
       .title = "Draw a surface",
       .description =
           "A picture of the surface from above, north up, transparent where there is no surface. Where surfaces are "
           "coloured by height, a colour bar and a scale bar stand beside the map; the scale is that of its middle.",
       .inputs = {{"surface", 1, 1, false, "The surface: a TIN or a raster."}},
       .result = ResultKind::picture},
      run);
}

}  // namespace terrane
