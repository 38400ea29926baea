// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/context.hpp"
#include "core/mosaic.hpp"
#include "core/plan_metric.hpp"

namespace terrane {

/// What was bridged. `area` in squared plan units.
struct Bridged {
  std::size_t slits = 0, faces = 0;
  double area = 0;
};

/// Fills the slits between the tiles of a surface, up to `gap` wide, with faces between their borders.
///
/// What lies outside the surface is triangulated with the borders as constraints; border vertices that face another
/// tile's edge within the gap first give that edge a vertex at their foot, and edges that part from each other are cut
/// where they are `gap` apart, so that the triangles of a slit are as long as it is wide and end where it gets too
/// wide. A triangle bridges when it lies between a border edge and a vertex no further than `gap` from it, or, where
/// slits meet, when two of its sides are no longer than that. Of these all go, one after the other, that would leave an
/// open side longer than `gap`: so no way from any place of a slit across it is longer, and islands further apart stay
/// islands. What touches one tile only is no slit between tiles: cracks and voids of a tile stay as they are.
///
/// Heights are those of the border vertices on both sides. The new faces' contributors are the tiles on both sides. The
/// result depends on the surface alone. O(n + b log b) for n faces and b border edges, and what lies within the gap.
Bridged bridge_gaps(Piece& piece, ContributorSets& sets, double gap, const PlanMetric& metric, Context& context);

}  // namespace terrane
