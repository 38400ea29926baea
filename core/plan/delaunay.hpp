// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/tin.hpp"

namespace terrane {

/// The constrained Delaunay triangulation of the convex hull of points at different places, with edges that cross
/// nowhere and run through no other point. Exact predicates; no point is constructed. O(n log n).
Tin constrained_delaunay(std::span<const Point> points, std::span<const std::array<Index, 2>> edges);

/// Do edges between points at different places meet at their ends only? Then none crosses another or runs through a
/// point. Exact; O(n log n) expected, however long and close to each other the edges are.
bool meet_at_ends_only(std::span<const Point2> points, std::vector<std::array<Index, 2>> edges);

}  // namespace terrane
