// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "core/tin.hpp"
#include "core/topology.hpp"

// The mends of validation: each changes the mesh and leaves the surface where it was.
namespace terrane {

/// Heights this close at one place are one height, rounded.
double height_rounding(double z);

/// Makes the faces use one vertex per place and height; `used` says which vertices count. Of several the lowest number
/// stays, at the lowest of their heights. Returns (vertex that went, vertex that stayed), by the former.
std::vector<std::pair<Index, Index>> weld_duplicates(Tin& tin, const Array<Index>& places,
                                                     const std::vector<bool>& used);

/// Splits faces at the places that lie on their edges (T-junctions, as examine_border lists them): the first part stays
/// where the face was, the others are appended, and so are their originals. A new vertex takes the height of the split
/// edge unless one within height_rounding stands there already.
void split_at_touches(Tin& tin, const PlanTopology& topology, const std::vector<BorderReport::Touch>& touches,
                      std::vector<Index>& originals);

}  // namespace terrane
