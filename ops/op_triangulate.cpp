// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/inputs.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"

namespace terrane {
namespace {

struct TriangulateParameters {
  std::optional<long> max_triangles;

  void visit(Fields& f) {
    f.integer("max-triangles", max_triangles, {.minimum = 2, .maximum = 1e9},
              "Stop at about that many faces, even if max-error is not reached; the error reached is reported.");
  }
};

/// The common frame has triangulated the raster, within max-error in the result's CRS; nothing is left to do.
Outcome run(std::vector<Surface>& inputs, const TriangulateParameters&, Context&) {
  Outcome outcome;
  outcome.result = std::move(std::get<Tin>(input(inputs, "dem").value));
  return outcome;
}

}  // namespace

Operation triangulate_operation() {
  return operation<TriangulateParameters>(
      {.id = "triangulate",
       .title = "Triangulate a raster",
       .description =
           "A TIN that is nowhere further (vertically) than max-error from the samples of a DEM; voids become "
           "holes.",
       .inputs = {{"dem", 1, 1, false, "The raster: GeoTIFF, HGT or ASCII grid."}},
       .intake = {.raster_only = true}},
      run);
}

}  // namespace terrane
