// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/merge.hpp"
#include "ops/heights.hpp"
#include "ops/inputs.hpp"
#include "ops/measure.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"
#include "ops/seams.hpp"
#include "ops/union_area.hpp"

namespace terrane {
namespace {

struct MergeParameters {
  Overlap overlap = Overlap::first;
  Seam seam = Seam::wall;
  Length z_tolerance;

  void visit(Fields& f) {
    f.choice(
        "overlap", overlap,
        {{"first", Overlap::first},
         {"last", Overlap::last},
         {"min", Overlap::min},
         {"max", Overlap::max},
         {"mean", Overlap::mean},
         {"sum", Overlap::sum}},
        "Which height holds where tiles overlap: that of the first or last tile in the order given, the lowest, the "
        "highest, their mean, or their sum.");
    f.choice("seam", seam, {{"wall", Seam::wall}, {"split", Seam::split}},
             "What happens where heights jump at a seam: closed by vertical faces, or left open.");
    f.length("z-tolerance", z_tolerance, {.minimum = 0}, "Jumps up to this height are closed without a wall.");
  }
};

/// Interval arithmetic on what the tiles say, one rule per policy.
HeightFold folded(Overlap overlap) {
  return [overlap](const std::vector<std::optional<HeightRange>>& tiles) -> std::optional<HeightRange> {
    std::optional<HeightRange> result;
    int count = 0;
    for (const auto& z : tiles) {
      if (!z) continue;
      ++count;
      if (!result || overlap == Overlap::last) {
        result = z;
        continue;
      }
      if (overlap == Overlap::min) result = {std::min(result->low, z->low), std::min(result->high, z->high)};
      if (overlap == Overlap::max) result = {std::max(result->low, z->low), std::max(result->high, z->high)};
      if (overlap == Overlap::sum || overlap == Overlap::mean) result = {result->low + z->low, result->high + z->high};
    }
    if (result && overlap == Overlap::mean) result = {result->low / count, result->high / count};
    return result;
  };
}

Outcome run(std::vector<Surface>& inputs, const MergeParameters& p, Context& context) {
  std::vector<Tin> tiles;
  std::vector<std::string> names;
  for (Surface& s : inputs) {
    names.push_back(s.name);
    tiles.push_back(std::get<Tin>(s.value));
  }
  const Crs& crs = inputs.front().crs;
  const double tolerance = p.z_tolerance.in(crs.known() ? crs.metres_per_height_unit() : 1.0);
  Outcome outcome;
  std::vector<const Tin*> all;
  for (const Surface& s : inputs) all.push_back(&s.tin());
  outcome.fields = height_fields(all, context);
  outcome.expected_area = union_area(outcome.fields, context);
  Merged merged = merge(tiles, {p.overlap, {p.seam, tolerance}}, context);
  if (merged.surface.max_closed_jump > 0 && tolerance > 0)
    context.warn(
        {"jumps-closed", "", "",
         "jumps of up to " + nlohmann::json(merged.surface.max_closed_jump).dump() + " were closed within z-tolerance",
         ""});
  for (const SeamPair& pair : merged.seams)
    if (pair.bias_suspected)
      context.warn({"bias-suspected", names[pair.b], "",
                    "'" + names[pair.b] + "' lies " + nlohmann::json(std::fabs(pair.dz_median)).dump() + " (median) " +
                        (pair.dz_median > 0 ? "above" : "below") + " '" + names[pair.a] +
                        "' where they overlap, more than their scatter explains",
                    "check their vertical datums and units"});
  outcome.certificate["seams"] = seam_report(merged.seams, names);
  outcome.expected_height = folded(p.overlap);
  outcome.rounding = merged.surface.rounding;
  outcome.result = std::move(merged.surface.tin);
  return outcome;
}

}  // namespace

Operation merge_operation() {
  return operation<MergeParameters>(
      {.id = "merge",
       .title = "Merge tiles into one surface",
       .description =
           "One TIN of any number of tiles. Where they overlap a policy decides; where they share only a border it "
           "is made conforming; islands stay apart. The seams are reported.",
       .inputs = {{"tiles", 1, 0, false, "The tiles: TINs or rasters. Rasters on one lattice are joined first."}},
       .intake = {.join_rasters = true, .empty_allowed = true}},
      run);
}

}  // namespace terrane
