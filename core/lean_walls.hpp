// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/context.hpp"
#include "core/plan_metric.hpp"
#include "core/tin.hpp"

namespace terrane {

struct Leaned {
  Tin tin;                // canonical: every place has one height, and there are no walls
  std::size_t moved = 0;  // feet of walls
  double max_move = 0;    // the furthest a foot was moved
  double min_offset = 0;  // the least distance between a foot and the wall it belonged to; 0 when nothing was moved
  double max_shift = 0;   // of any vertex, in plan units, where slivers had to go first
};

/// Walls, or open jumps, leaned by `offset` in plan, for formats and programs that cannot hold two heights at one
/// place.
///
/// The highest surface at a place stays. Every lower one draws its vertex back inside itself, `offset` away from its
/// edges that were walls, and along the border of the domain where it ends there; the vertex has the height its surface
/// has at its new place. What opens between is triangulated (constrained Delaunay): the leaned wall. Where a lower
/// surface is too narrow for that its vertex moves half as far, or half of that again, until no face turns over,
/// decided exactly. The domain stays the same but for rounding, and but for corners at which parts of it touch at
/// different heights, which come apart.
///
/// Surfaces beside a wall that are as thin as rounding have no room: then the whole is first put on a grid of 1/64 of
/// the offset (core/plan_grid), on which they are gone, and max_shift says so.
///
/// `tin` is valid and canonical (core/validate). O(n + w log w) for w walls. Throws Error{input, "wall-offset"} when
/// the result is not valid however little is moved.
Leaned lean_walls(const Tin& tin, double offset, const PlanMetric& metric, Context& context);

}  // namespace terrane
