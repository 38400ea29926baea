// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/context.hpp"
#include "core/shapes.hpp"
#include "core/tin.hpp"

// What a set of polygons means as an area of the plane: the region of interest that surfaces are cut with.
namespace terrane {

struct PlanRegion {
  /// Its constrained Delaunay triangulation, level at 0, in canonical order; vertices lie on its border.
  Tin tin;
  /// Its border, the region on the left of every edge.
  std::vector<std::array<Point2, 2>> border;
  /// Where rings of one polygon first cross or overlap, other than by touching in points.
  std::optional<Point2> self_crossing;

  bool empty() const { return tin.faces.empty(); }
};

/// The union of the polygons. Inside a polygon is what lies within its outer ring, by parity where that crosses itself,
/// and in none of its holes, wherever they lie. Orientation of rings is ignored, and so are rings without area. Where
/// rings cross each other the crossing becomes a vertex at the nearest double; everything else is exact: corners stay
/// bit for bit, and which side is inside is decided without constructed coordinates. Edges between two polygons that
/// share them vanish. Throws Error{input, "not-finite"} naming a corner that is NaN or infinite. O(n log n) for short
/// edges that cross little.
PlanRegion plan_region(std::span<const Polygon> polygons, const Context& context);

/// A box as a region. Precondition: it has an area.
PlanRegion plan_region(const Box& box);

/// Does the place lie inside the region (+1), on its border (0) or outside (-1)? Exact; O(border).
int side_of(const PlanRegion& region, Point2 place);

}  // namespace terrane
