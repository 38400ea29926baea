// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/overlay/arrangement.hpp"

namespace terrane {

/// Sorts the pieces that leave each junction and joins those of A and B that run in one direction. Fills first_spoke
/// and spokes. `node_of[m]`: of a place of m that lies inside an edge of the other mesh, its node in the lines of that
/// mesh. Junctions all of whose faces are shared by both meshes have no spokes: nothing is ever traced through them.
/// O(spokes), exact.
void join_spokes(Arrangement& arrangement, const Array<Index> (&node_of)[2]);

}  // namespace terrane
