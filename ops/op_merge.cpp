// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/lean_walls.hpp"
#include "ops/heights.hpp"
#include "ops/measure.hpp"
#include "ops/merging.hpp"
#include "ops/operations.hpp"
#include "ops/ramps.hpp"
#include "ops/union_area.hpp"

namespace terrane {
namespace {

std::optional<HeightRange> median(const std::vector<std::optional<HeightRange>>& tiles) {
  std::vector<double> low, high;
  for (const auto& z : tiles)
    if (z) low.push_back(z->low), high.push_back(z->high);
  if (low.empty()) return {};
  std::sort(low.begin(), low.end());
  std::sort(high.begin(), high.end());
  const std::size_t i = (low.size() - 1) / 2, j = low.size() / 2;
  return HeightRange{low[i] + (low[j] - low[i]) / 2, high[i] + (high[j] - high[i]) / 2};
}

HeightRange cut_off(HeightRange z, Overlap overlap, double level) {
  if (overlap == Overlap::max) return {std::max(z.low, level), std::max(z.high, level)};
  return {std::min(z.low, level), std::min(z.high, level)};
}

/// Interval arithmetic on what the tiles say, one rule per policy.
HeightFold folded(Overlap overlap, std::optional<double> level) {
  return [overlap, level](const std::vector<std::optional<HeightRange>>& tiles) -> std::optional<HeightRange> {
    if (overlap == Overlap::median) return median(tiles);
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
      if (overlap == Overlap::blend) result = {std::min(result->low, z->low), std::max(result->high, z->high)};
      if (overlap == Overlap::sum || overlap == Overlap::mean) result = {result->low + z->low, result->high + z->high};
    }
    if (result && overlap == Overlap::mean) result = {result->low / count, result->high / count};
    if (result && level) result = cut_off(*result, overlap, *level);
    return result;
  };
}

/// Of several heights the one that the policy takes; none where it makes a new one of them.
Decider decider(Overlap overlap) {
  return [overlap](const std::vector<std::optional<double>>& z) -> Index {
    std::vector<Index> there;
    for (Index i = 0; i < static_cast<Index>(z.size()); ++i)
      if (z[i]) there.push_back(i);
    if (there.empty()) return none;
    if (there.size() == 1 || overlap == Overlap::first) return there.front();
    if (overlap == Overlap::last) return there.back();
    std::stable_sort(there.begin(), there.end(), [&](Index i, Index j) { return *z[i] < *z[j]; });
    if (overlap == Overlap::min) return there.front();
    if (overlap == Overlap::max)
      return *std::find_if(there.begin(), there.end(), [&](Index i) { return *z[i] == *z[there.back()]; });
    if (overlap == Overlap::median && there.size() % 2 == 1) return there[there.size() / 2];
    return none;
  };
}

Outcome run(std::vector<Surface>& inputs, const MergeParameters& p, Context& context) {
  const Crs& crs = inputs.front().crs;
  const MergeTiles tiles = merge_tiles(inputs, p, context);
  Outcome outcome;
  std::vector<const Tin*> all;
  for (const Tin& tile : *tiles.tiles) all.push_back(&tile);
  outcome.fields = height_fields(all, context);
  outcome.expected_area = union_area(outcome.fields, context);
  Merged merged = terrane::merged(tiles, crs, p, context);
  if (outcome.expected_area) *outcome.expected_area += merged.bridged.area;
  outcome.certificate = merge_report(tiles, merged, crs);
  // The fields look at the tiles, which the fold keeps.
  const bool bent = p.overlap == Overlap::blend && p.blend_side != BlendSide::both;
  outcome.expected_height = [fold = folded(bent ? Overlap::first : p.overlap, tiles.level),
                             kept = tiles.tiles](const auto& z) { return fold(z); };
  // Vertices made on a blend of those before are as near as it is.
  const double slack = merged.blend.bound * (static_cast<double>(tiles.tiles->size()) - 2);
  if (p.overlap == Overlap::blend && slack > 0)
    outcome.expected_height = [fold = std::move(outcome.expected_height), bound = slack](const auto& z) {
      std::optional<HeightRange> range = fold(z);
      if (range) range->low -= bound, range->high += bound;
      return range;
    };
  leave_ramps_out(std::move(merged.surface.ramps), bent ? "bent" : "ramps", crs, outcome, context);
  if (p.overlap == Overlap::blend) outcome.approximation["blend"] = blend_report(merged, crs, p);
  outcome.decider = decider(p.overlap);
  outcome.rounding = merged.surface.rounding;
  if (const double offset = plan_length(p.wall_offset, crs); offset > 0 && p.seam == Seam::wall) {
    Leaned leaned = lean_walls(merged.surface.tin, offset, plan_metric(crs), context);
    outcome.certificate["wall_offset"] = {{"moved", leaned.moved},
                                          {"max_move", leaned.max_move},
                                          {"min_offset", leaned.min_offset},
                                          {"length_unit", length_unit(crs)}};
    outcome.rounding->max_move = std::max(outcome.rounding->max_move, leaned.max_shift);
    merged.surface.tin = std::move(leaned.tin);
  }
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
       .inputs = {tiles_slot()},
       .intake = {.join_rasters = true, .empty_allowed = true},
       .check = check_merge},
      run);
}

}  // namespace terrane
