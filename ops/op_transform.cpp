// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/error.hpp"
#include "ops/inputs.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"

namespace terrane {
namespace {

struct TransformParameters {
  double z_scale = 1;
  Length z_offset;

  void visit(Fields& f) {
    f.number("z-scale", z_scale, {}, "", "What every height is multiplied by, after the transformation.");
    f.length("z-offset", z_offset, {}, "What is then added to every height.");
  }
};

/// The common frame has transformed the plan; what is left are the heights.
Outcome run(std::vector<Surface>& inputs, const TransformParameters& p, Context&) {
  Surface& surface = input(inputs, "surface");
  Tin tin = std::move(std::get<Tin>(surface.value));
  const double offset = p.z_offset.in(surface.crs.known() ? surface.crs.metres_per_height_unit() : 1.0);
  if (p.z_scale != 1 || offset != 0)
    tin = with_heights(std::move(tin), p.z_scale, offset, surface.name,
                       "z-scale=" + nlohmann::json(p.z_scale).dump() + " and z-offset=" +
                           nlohmann::json(offset).dump());
  Outcome outcome;
  outcome.result = std::move(tin);
  return outcome;
}

void check(const nlohmann::json& values, const std::vector<InputPart>&) {
  const auto p = filled<TransformParameters>(values);
  if (p.z_scale == 0)
    throw Error(ErrorKind::usage, "bad-parameter", "parameter 'z-scale' is 0, which would flatten the surface");
  if (!values.contains("target-crs") && p.z_scale == 1 && p.z_offset.value == 0)
    throw Error(ErrorKind::usage, "missing-parameter", "'transform' needs target-crs, z-scale or z-offset");
}

}  // namespace

Operation transform_operation() {
  return operation<TransformParameters>(
      {.id = "transform",
       .title = "Transform a surface to another CRS",
       .description =
           "The surface in another coordinate reference system (target-crs), with the planarity error this causes "
           "(straight edges bend); or with its heights scaled and shifted.",
       .inputs = {{"surface", 1, 1, false, "The surface: a TIN or a raster."}},
       .check = check,
       .example = {.parameters = {{"target-crs", "EPSG:4326"}}}},
      run);
}

}  // namespace terrane
