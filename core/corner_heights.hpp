// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "core/surface.hpp"

namespace terrane {

/// Jumps up to this are rounding: the same height computed by two routes.
inline double rounding_jump(double z) { return 1e-9 * (z > 1 ? z : z < -1 ? -z : 1); }

/// The corners (3 * face + corner) at every place, faces ascending: those of point p are corners[first[p]] to
/// corners[first[p + 1] - 1].
struct CornersByPlace {
  std::vector<std::size_t> first, corners;
};
CornersByPlace corners_by_place(const Array<Face>& faces, std::size_t points);

/// Makes one double of the heights at a place that lie within rounding of each other, preferring firm ones, then the
/// first face's; afterwards of those within `z_tolerance` of the height of the face that comes first. Places for which
/// `wanted` is false are left alone. Returns the largest move. O(corners).
double close_jumps(CornerSurface& surface, const CornersByPlace& places, double z_tolerance,
                   const std::function<bool(Point2)>& wanted = {});

}  // namespace terrane
