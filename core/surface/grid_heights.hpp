// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/overlay/completed.hpp"
#include "core/rounding/rounding.hpp"
#include "core/surface.hpp"

// Heights of a surface whose places have moved and become fewer.
namespace terrane {

/// The live real faces of `mesh` (labels: faces of `completed`, none for ghosts) with the heights of the TIN. They
/// travel with their vertices; of places that became one that with most heights gives them, the lowest number in doubt,
/// and each other height becomes the nearest of these. O(n).
CornerSurface with_heights_of(const Tin& tin, const CompletedMesh& completed, PlanarMesh mesh,
                              const std::vector<Index>& merged_into);

/// Merges can leave heights at a place that no longer make a surface with walls (or open jumps): a jump that changes
/// its sign along an edge, or two heights that no jump along an edge joins. Such heights become the lower one. Linear
/// in the faces, as many times as heights go in turn: one or two in practice.
void reconcile_heights(CornerSurface& surface, const Array<Face>& neighbours, bool walls);

}  // namespace terrane
