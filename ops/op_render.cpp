// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "ops/inputs.hpp"
#include "ops/measure.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"

namespace terrane {
namespace {

enum class Shading { hillshade };

struct RenderParameters {
  long size = 1024;
  Shading shading = Shading::hillshade;

  void visit(Fields& f) {
    f.integer("size", size, {.minimum = 16, .maximum = 8192}, "Pixels along the longer side of the picture.");
    f.choice("shading", shading, {{"hillshade", Shading::hillshade}}, "How heights are shown.");
  }
};

Outcome run(std::vector<Surface>& inputs, const RenderParameters& p, Context& context) {
  const Surface& surface = input(inputs, "surface");
  ShadeOptions options;
  options.size = static_cast<int>(p.size);
  const Crs& crs = surface.crs;
  if (crs.known() && crs.geographic()) {
    const Box box = bounds(surface.tin());
    const double latitude = (box.ymin + box.ymax) / 2;
    options.x_factor = std::max(0.01, std::cos(latitude * std::numbers::pi / 180));
    options.z_factor =
        distance({box.xmin, latitude - 0.5}, {box.xmin, latitude + 0.5}, crs) / crs.metres_per_height_unit();
  } else if (crs.known()) {
    options.z_factor = crs.metres_per_length_unit() / crs.metres_per_height_unit();
  }
  Outcome outcome;
  outcome.result = hillshade(surface.tin(), options, context);
  return outcome;
}

}  // namespace

Operation render() {
  return operation<RenderParameters>(
      {.id = "render",
       .title = "Draw a surface",
       .description = "A picture of the surface from above, north up, transparent where there is no surface.",
       .inputs = {{"surface", 1, 1, false, "The surface: a TIN or a raster."}},
       .result = ResultKind::picture},
      run);
}

}  // namespace terrane
