// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/plan/exact_place.hpp"
#include "core/tin.hpp"

// Triangulations of regions given by their borders: the only place where general polygons with holes are triangulated.
namespace terrane {

/// A directed edge of a region's border, the region on its left. `tag` is the caller's.
struct BorderEdge {
  Index from, to;
  Index tag = none;
};

struct FilledRegion {
  bool sound = false;       // false: border edges cross or run through a vertex; the rest is then empty
  std::vector<Face> faces;  // counter-clockwise, indices as in the border
  /// across[f][k]: what lies beyond the half-edge from corner k to k + 1: another face as 4 * face + its half-edge,
  /// or -1 - i for border edge i.
  std::vector<std::array<Index, 3>> across;
  Index parts = 0;  // connected components
};

/// Constrained Delaunay triangulation of the region to the left of `border`: several components, holes and islands at
/// will. An edge with the region on both sides is given in both directions. `inner` are vertices inside the region that
/// no border edge ends at. Exact predicates; no point is ever constructed. O(b log b).
FilledRegion fill_region(std::span<const Point2> points, std::span<const BorderEdge> border,
                         std::span<const Index> inner = {});

/// The same, decided at exact places, for regions whose doubles no longer say how they hang together.
FilledRegion fill_region_exactly(std::span<const Point2> points, const std::function<ExactPlace(Index)>& place,
                                 std::span<const BorderEdge> border);

}  // namespace terrane
