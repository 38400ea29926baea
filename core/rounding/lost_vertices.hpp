// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "core/rounding/mesh_editor.hpp"

namespace terrane {

/// Mending may close the tip of a face: two crossings next to an input vertex become one, and the vertex is left with
/// faces of the exterior (label none) only. Merges into each such vertex the nearest constructed vertex beside it,
/// within `bound`, that has a labelled face, where every face stays or can be made positive and within `bound` of its
/// label; first those that have none, where they stand between. Where there is none such, a face of the exterior beside
/// the vertex goes to the region next to it, if that is within `bound` too: as the faces are, after an edge of the
/// exterior is flipped, or after such merges. Returns how many could not be kept: those at the end of faces thinner
/// than rounding.
Index keep_input_vertices(MeshEditor& editor, const std::function<ExactPlace(Index)>& place, const Spill& spill,
                          double bound);

}  // namespace terrane
