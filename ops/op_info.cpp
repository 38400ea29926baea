// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/validate.hpp"
#include "ops/inputs.hpp"
#include "ops/measure.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"

namespace terrane {
namespace {

struct InfoParameters {
  void visit(Fields&) {}
};

nlohmann::json crs_json(const Crs& crs) {
  if (!crs.known()) return nullptr;
  return {{"id", crs.id()},
          {"name", crs.name()},
          {"geographic", crs.geographic()},
          {"vertical_datum", crs.vertical_datum()}};
}

Outcome run(std::vector<Surface>& inputs, const InfoParameters&, Context& context) {
  const Surface& surface = input(inputs, "surface");
  const Tin& tin = surface.tin();
  const Inspection seen = inspect(tin, context);
  const Units units = units_of(surface.crs);
  nlohmann::json report = {{"type", "SurfaceInfo"},
                           {"name", surface.name},
                           {"kind", surface.source.is_null() ? "tin" : "raster"},
                           {"raster", surface.source},
                           {"crs", crs_json(surface.crs)},
                           {"units", {{"length", units.length}, {"height", units.height}, {"area", units.area}}},
                           {"vertices", seen.vertices},
                           {"faces", seen.faces},
                           {"walls", seen.walls},
                           {"components", seen.components},
                           {"holes", seen.holes},
                           {"extent", nullptr},
                           {"height_range", nullptr},
                           {"topology",
                            {{"inverted", seen.inverted},
                             {"degenerate", seen.degenerate},
                             {"t_junctions", seen.t_junctions},
                             {"non_manifold_edges", seen.non_manifold_edges},
                             {"overlaps", seen.overlaps}}}};
  if (!tin.vertices.empty()) {
    const Box box = bounds(tin);
    const HeightSpan heights = height_span(tin);
    report["extent"] = {{"xmin", box.xmin}, {"ymin", box.ymin}, {"xmax", box.xmax}, {"ymax", box.ymax}};
    report["height_range"] = {heights.low, heights.high};
  }
  const Outline border = outline(tin, surface.crs);
  report["border"] = {{"edges", border.edges}, {"loops", border.loops}, {"length", border.length}};
  report["area_2d"] = domain_area(tin, surface.crs, context);
  report["area_3d"] = surface_area(tin, surface.crs);
  Outcome outcome;
  outcome.result = std::move(report);
  return outcome;
}

}  // namespace

Operation info() {
  return operation<InfoParameters>(
      {.id = "info",
       .title = "Describe a surface",
       .description =
           "Counts, extent, CRS, units, height range, components, borders and areas. Never refuses what can be read.",
       .inputs = {{"surface", 1, 1, false, "The surface: a TIN or a raster."}},
       .result = ResultKind::report,
       .intake = {.check = false, .empty_allowed = true}},
      run);
}

}  // namespace terrane
