// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "core/context.hpp"
#include "core/rounding/mesh_editor.hpp"

namespace terrane {

struct KineticMoves {
  Index vertices = 0;
  double shift = 0;  // the largest distance of a vertex's new rounded place from its old one
};

/// Kinetic rounding: puts the constructed vertices of the bad faces (and of every face they then spoil) back at their
/// exact places, where all faces are positive, and moves them one by one, the one with the shortest way first (in doubt
/// the lower number), to their rounded places. The first face to become flat on the way is an edge flip when its middle
/// vertex lies inside the opposite edge, a merge when two vertices meet at the end, and a detour by a waypoint when
/// they meet on the way; a vertex that no detour brings there gets a new rounded place, up to 3 ulp beside. Signs and
/// the order of events are exact: nothing is guessed. Ends: exact places are valid, and a vertex on a segment meets
/// finitely many collinearities. Faces it could not mend stay bad. About 5 us a vertex.
KineticMoves move_kinetically(MeshEditor& editor, const std::vector<Index>& bad,
                              const std::function<ExactPlace(Index)>& place, Context& context);

}  // namespace terrane
