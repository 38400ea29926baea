// SPDX-License-Identifier: GPL-3.0-or-later

#include "ops/measure.hpp"
#include "ops/merging.hpp"
#include "ops/operations.hpp"
#include "ops/seams.hpp"

namespace terrane {
namespace {

Outcome run(std::vector<Surface>& inputs, const MergeParameters& p, Context& context) {
  const Crs& crs = inputs.front().crs;
  const MergeTiles tiles = merge_tiles(inputs, p, context);
  const Merged merged = terrane::merged(tiles, crs, p, context);
  nlohmann::json report = merge_report(tiles, merged, crs);
  report.update(report["seams"]);
  report.erase("seams");
  report["type"] = "SeamReport";
  report["crs"] = crs.known() ? crs.id() : "";
  const Units units = units_of(crs);
  report["units"] = {{"length", units.length}, {"height", units.height}};
  Outcome outcome;
  outcome.result = std::move(report);
  outcome.features = [lines = seam_lines(merged, tiles.names, crs)] { return lines; };
  return outcome;
}

}  // namespace

Operation seams_operation() {
  return operation<MergeParameters>(
      {.id = "seams",
       .title = "Report the seams between tiles",
       .description =
           "How well tiles agree, before they are merged: for each pair that overlaps or shares a border the "
           "differences in height over the overlap, and the jumps that a merge with the same parameters would leave. "
           "As "
           "a report, or as lines along the seams with their jumps (b - a at start and end, the largest, the length).",
       .inputs = {tiles_slot()},
       .output_formats = {"json", "geojson", "gpkg", "dxf"},
       .result = ResultKind::report,
       .intake = {.join_rasters = true, .empty_allowed = true},
       .check = check_merge},
      run);
}

}  // namespace terrane
