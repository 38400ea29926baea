// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/merge.hpp"
#include "core/snap_borders.hpp"
#include "ops/operation.hpp"
#include "ops/outcome.hpp"
#include "ops/parameters.hpp"

// What merge and seams have in common: the same parameters, the same tiles, merged the same way.
namespace terrane {

struct MergeParameters {
  Overlap overlap = Overlap::first;
  Seam seam = Seam::wall;
  Length z_tolerance, snap, gap, wall_offset;
  Length blend_width, blend_tolerance = {0.01, "m"};
  BlendSide blend_side = BlendSide::both;

  void visit(Fields& f) {
    f.choice(
        "overlap", overlap,
        {{"first", Overlap::first},
         {"last", Overlap::last},
         {"min", Overlap::min},
         {"max", Overlap::max},
         {"mean", Overlap::mean},
         {"median", Overlap::median},
         {"sum", Overlap::sum},
         {"blend", Overlap::blend}},
        "Which height holds where tiles overlap: that of the first or last tile in the order given, the lowest, the "
        "highest, their mean, their median (of an even number the mean of the middle two), their sum, or a blend that fades "
        "each tile into those before it.");
    f.length("blend-width", blend_width, {.minimum = 0},
             "How far from a tile's border the blend reaches, in plan; overlap=blend needs it. Where an overlap is "
             "narrower it fades across the whole of it.");
    f.choice("blend-side", blend_side,
             {{"both", BlendSide::both}, {"inside", BlendSide::inside}, {"outside", BlendSide::outside}},
             "Who gives way: both tiles within their overlap; inside: the earlier tile, within its border; outside: "
             "the later one beyond the border of the earlier, which stays untouched (a survey before a national DEM).");
    f.length("blend-tolerance", blend_tolerance, {.minimum = 0},
             "Faces are refined until they are nowhere further than this from the exact blend, in height.");
    f.choice("seam", seam, {{"wall", Seam::wall}, {"ramp", Seam::ramp}, {"split", Seam::split}},
             "What happens where heights jump at a seam: closed by vertical faces, sloped down outside the overlap "
             "within the faces that its border cuts or touches, or left open.");
    f.length("z-tolerance", z_tolerance, {.minimum = 0}, "Jumps up to this height are closed without a wall.");
    f.length("snap", snap, {.minimum = 0},
             "Border vertices are moved onto the nearest border vertex or edge of another tile within this distance in "
             "plan, before anything is merged. Never turns a face over: such a move is skipped and counted.");
    f.length("gap", gap, {.minimum = 0},
             "Slits between the borders of tiles up to this width are bridged by faces; nothing wider ever is.");
    f.length("wall-offset", wall_offset, {.minimum = 0},
             "Leans walls by this distance in plan: the foot of a wall moves inside the lower surface, so that every "
             "place has one height. 0 leaves walls vertical.");
  }
};

/// The inputs as a merge takes them: numbers are levels, the rest are tiles, snapped when that is asked for.
struct MergeTiles {
  std::shared_ptr<const std::vector<Tin>> tiles;
  std::vector<std::string> names;
  std::optional<double> level;  // the one that counts of all
  std::optional<SnapReport> snapped;
};
MergeTiles merge_tiles(const std::vector<Surface>& inputs, const MergeParameters& p, Context& context);

/// Merges, and warns of what the user should know.
Merged merged(const MergeTiles& tiles, const Crs& crs, const MergeParameters& p, Context& context);

/// The seam report with what snapping and bridging did.
nlohmann::json merge_report(const MergeTiles& tiles, const Merged& merged, const Crs& crs);

/// What the blend comes to, for accuracy.approximation.
nlohmann::json blend_report(const Merged& merged, const Crs& crs, const MergeParameters& p);

/// Refuses numbers beside policies that know none. Made before anything is decoded.
void check_merge(const nlohmann::json& parameters, const std::vector<InputPart>& inputs);

/// The inputs and intake of both.
InputSlot tiles_slot();

}  // namespace terrane
