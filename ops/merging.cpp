// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/merging.hpp"

#include <algorithm>
#include <cmath>

#include "core/box.hpp"
#include "core/error.hpp"
#include "ops/idle_parameters.hpp"
#include "ops/input_format.hpp"
#include "ops/measure.hpp"
#include "ops/seams.hpp"

namespace terrane {
namespace {

double height(const Length& length, const Crs& crs) {
  return length.in(crs.known() ? crs.metres_per_height_unit() : 1.0);
}

void warn_of_bias(const SeamPair& pair, const std::vector<std::string>& names, Context& context) {
  context.warn({"bias-suspected", names[pair.b], "",
                "'" + names[pair.b] + "' lies " + nlohmann::json(std::fabs(pair.dz_median)).dump() + " (median) " +
                    (pair.dz_median > 0 ? "above" : "below") + " '" + names[pair.a] +
                    "' where they overlap, more than their scatter explains",
                "check their vertical datums and units"});
}

/// Widths count at the middle of the tiles where the CRS has degrees.
BlendOptions blend_options(const std::vector<Tin>& tiles, const Crs& crs, const MergeParameters& p) {
  Box all = no_box;
  for (const Tin& tile : tiles)
    if (!tile.faces.empty()) all = around(all, bounds(tile));
  return {plan_length(p.blend_width, crs), p.blend_side, height(p.blend_tolerance, crs),
          plan_metric(crs).at((all.ymin + all.ymax) / 2)};
}

}  // namespace

MergeTiles merge_tiles(const std::vector<Surface>& inputs, const MergeParameters& p, Context& context) {
  MergeTiles made;
  std::vector<Tin> tiles;
  for (const Surface& s : inputs) {
    if (s.level()) {
      const double level = std::get<double>(s.value);
      if (!made.level) made.level = level;
      made.level = p.overlap == Overlap::max ? std::max(*made.level, level) : std::min(*made.level, level);
      continue;
    }
    made.names.push_back(s.name);
    tiles.push_back(s.tin());
  }
  const Crs& crs = inputs.front().crs;
  if (const double distance = plan_length(p.snap, crs); distance > 0) {
    SnappedTiles snapped = snap_borders(tiles, distance, plan_metric(crs), context);
    made.snapped = snapped.report;
    tiles = std::move(snapped.tiles);
    if (made.snapped->skipped > 0)
      context.warn({"snap-skipped", "", "",
                    std::to_string(made.snapped->skipped) +
                        " border vertices within the snap distance stay where they are, because a face or a border "
                        "would turn over",
                    "use a smaller snap"});
  }
  made.tiles = std::make_shared<const std::vector<Tin>>(std::move(tiles));
  return made;
}

Merged merged(const MergeTiles& tiles, const Crs& crs, const MergeParameters& p, Context& context) {
  const double tolerance = height(p.z_tolerance, crs);
  MergeOptions options{p.overlap, {p.seam, tolerance}};
  options.level = tiles.level;
  options.gap = plan_length(p.gap, crs);
  options.metric = plan_metric(crs);
  if (p.overlap == Overlap::blend) options.blend = blend_options(*tiles.tiles, crs, p);
  Merged merged = merge(*tiles.tiles, options, context);
  if (merged.surface.max_closed_jump > 0 && tolerance > 0)
    context.warn(
        {"jumps-closed", "", "",
         "jumps of up to " + nlohmann::json(merged.surface.max_closed_jump).dump() + " were closed within z-tolerance",
         ""});
  for (const SeamPair& pair : merged.seams)
    if (pair.bias_suspected) warn_of_bias(pair, tiles.names, context);
  return merged;
}

nlohmann::json merge_report(const MergeTiles& tiles, const Merged& merged, const Crs& crs) {
  nlohmann::json report = {{"seams", seam_report(merged.seams, tiles.names)}};
  if (tiles.snapped)
    report["snap"] = {{"moved", tiles.snapped->moved},         {"inserted", tiles.snapped->inserted},
                      {"skipped", tiles.snapped->skipped},     {"max_move", tiles.snapped->max_move},
                      {"mean_move", tiles.snapped->mean_move}, {"length_unit", length_unit(crs)}};
  if (merged.bridged.faces > 0)
    report["gap"] = {{"slits", merged.bridged.slits},
                     {"faces", merged.bridged.faces},
                     {"area_2d", merged.bridged.area},
                     {"area_unit", "squared CRS units"}};
  return report;
}

nlohmann::json blend_report(const Merged& merged, const Crs& crs, const MergeParameters& p) {
  return {{"tolerance", height(p.blend_tolerance, crs)},
          {"bound", merged.blend.bound},
          {"against", "the exact blend of each tile with those before it, everywhere on the faces"},
          {"vertices_made", merged.blend.made},
          {"unresolved", {{"places", merged.blend.corners}, {"radius", merged.blend.radius}}}};
}

void check_merge(const nlohmann::json& parameters, const std::vector<InputPart>& inputs) {
  const InputSlot slot = tiles_slot();
  std::size_t levels = 0;
  for (const InputPart& part : inputs) levels += level_of(part, slot).has_value();
  const auto p = filled<MergeParameters>(parameters);
  if (p.overlap == Overlap::blend && !(p.blend_width.value > 0))
    throw Error(ErrorKind::usage, "blend-width", "overlap=blend needs blend-width, greater than 0");
  if (p.overlap == Overlap::blend && !(p.blend_tolerance.value > 0))
    throw Error(ErrorKind::usage, "blend-tolerance", "blend-tolerance must be greater than 0");
  if (p.overlap != Overlap::blend)
    refuse_idle<MergeParameters>(parameters, {"blend-width", "blend-side", "blend-tolerance"}, "overlap=blend");
  if (p.seam != Seam::wall) refuse_idle<MergeParameters>(parameters, {"wall-offset"}, "seam=wall");
  if (levels > 0 && p.overlap != Overlap::min && p.overlap != Overlap::max)
    throw Error(ErrorKind::usage, "level-as-tile",
                "a number as a tile is a level, which overlap=min and overlap=max know; overlap is '" +
                    parameters.at("overlap").get<std::string>() + "'");
  if (levels > 0 && levels == inputs.size())
    throw Error(ErrorKind::usage, "missing-input",
                "levels alone make no surface; at least one tile must be a TIN or a raster");
}

InputSlot tiles_slot() {
  return {"tiles", 1, 0, true,
          "The tiles: TINs or rasters; rasters on one lattice are joined first. A number is a level that cuts the "
          "others off with overlap=min or overlap=max."};
}

}  // namespace terrane
