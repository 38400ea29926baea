// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/context.hpp"
#include "core/overlay/completed.hpp"

namespace terrane {

struct Snapped {
  CompletedMesh mesh;        // B, completed in the frame, its snapped vertices on A's
  Array<Location> location;  // of every place of B in A
  Index count = 0;           // places moved
  double max_move = 0;
};

/// Moves each vertex of B that is mutually nearest with a vertex of A within `tolerance` onto it, unless a face of B
/// would not stay positive or B's border simple. `mesh`: B completed in the frame; a moved B is completed anew.
Snapped snap_places(const Tin& b, const Box& frame, CompletedMesh mesh, const CompletedMesh& a, double tolerance,
                    Context& context);

}  // namespace terrane
