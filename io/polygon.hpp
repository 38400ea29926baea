// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/tin.hpp"

namespace terrane {

/// More corners than this are refused: clipping ears takes the square of them.
inline constexpr std::size_t max_polygon_corners = 1024;

/// Appends triangles of a polygon given by its corners: a fan when it is convex in plan (or vertical), clipped ears
/// when not. The triangles keep the polygon's own orientation. False when it has fewer than 3 or too many corners, or
/// crosses itself in plan; one that winds around a place twice may pass, and its triangles then overlap, which is for
/// validation to say. Exact predicates; O(n) when convex, else O(n^2).
bool append_polygon(std::vector<Face>& faces, const std::vector<Point>& vertices, std::span<const Index> corners);

}  // namespace terrane
