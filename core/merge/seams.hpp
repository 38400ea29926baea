// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "core/context.hpp"
#include "core/merge.hpp"
#include "core/mosaic.hpp"

namespace terrane {

/// What two tiles say of each other, from their own full overlay: statistics of dz = b - a where both have a surface,
/// exact for the piecewise linear dz, weighted by area as the metric has it. Nothing when they neither overlap nor
/// share a piece of border. Overlaps below 1e-10 of the smaller tile are borders that rounding made overlap. O(n log n)
/// in the faces near both.
std::optional<SeamPair> compare_tiles(const Tin& a, const Tin& b, const PlanMetric& metric, Context& context);

/// The jumps left between faces of different contributors, added to the pairs they belong to. `made_walls`: whether
/// they are closed by walls, whose area is then counted. Returns the jumps, a and b as in the pairs. O(n).
std::vector<SeamJump> attribute_jumps(const CornerSurface& surface, const std::vector<Index>& contributors,
                                      const ContributorSets& sets, double z_tolerance, bool made_walls,
                                      const PlanMetric& metric, std::vector<SeamPair>& pairs);

}  // namespace terrane
