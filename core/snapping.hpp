// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/completed.hpp"

namespace terrane {

struct Snapped {
  CompletedMesh mesh;              // B, completed in the frame, its snapped vertices on A's
  std::vector<Location> location;  // of every place of B in A
  Index count = 0;                 // places moved
  double max_move = 0;
};

/// Completes B and moves each of its vertices that is mutually nearest with a vertex of A within `tolerance` (negative:
/// 4 ulp of the largest coordinate) onto it, unless a face of B would not stay positive or B's border simple.
Snapped complete_and_snap(const Tin& b, const Box& frame, const CompletedMesh& a, double tolerance);

}  // namespace terrane
