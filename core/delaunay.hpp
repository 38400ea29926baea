// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "core/tin.hpp"

namespace terrane {

/// The constrained Delaunay triangulation of the convex hull of points at different places, with edges that cross
/// nowhere and run through no other point. Exact predicates; no point is constructed. O(n log n).
Tin constrained_delaunay(std::span<const Point> points, std::span<const std::array<Index, 2>> edges);

}  // namespace terrane
