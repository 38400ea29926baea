// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/context.hpp"
#include "core/overlay.hpp"
#include "core/plan_region.hpp"
#include "core/tin.hpp"

namespace terrane {

enum class Side { inside, outside };

struct Clipped {
  Tin tin;  // canonical; empty where the surface has nothing on that side
  RoundingReport rounding;
  std::size_t cut = 0;  // faces and walls of the surface that the border of the region divides
};

/// The part of a surface inside or outside a region. Precondition: the surface is valid, as checked() returns it.
/// Promises:
///  1. Faces that the region's border does not touch are returned as they are: same vertices, same corners.
///  2. A face that it cuts is replaced by the constrained Delaunay triangulation of its part; a new vertex has the
///     height of its face. A border that only touches a face's edge in a point makes that point a vertex of the face.
///     Nothing inside the region leaves a trace: how the region is triangulated is no part of the result.
///  3. The two sides are parts of one division: together they are the surface, their areas add up to its area, and
///     along the cut they have the same vertices, bit for bit.
///  4. Walls are cut at vertical lines above the border. One that stands along the border joins the two sides and
///     belongs to neither; a merge raises it again. Jumps that were open stay open.
///     A face thinner than rounding may be mended into a wall.
///  5. Of the region's corners, those within 4 ulp of a vertex of the surface are moved onto it (Overlay's snap).
/// Faces far from the border cost some 20 ns each; those near it an overlay. Rounding as in core/overlay.hpp, whose
/// errors are thrown.
Clipped clip(const Tin& surface, const PlanRegion& region, Side side, Context& context);

}  // namespace terrane
