// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "core/overlay.hpp"
#include "core/plan_region.hpp"
#include "core/tin.hpp"

namespace terrane {

/// A surface some of whose faces have been overlaid with a region (Refinement::outline).
struct CutSurface {
  const Tin& surface;
  const PlanRegion& region;
  const std::vector<Index>& faces;  // of the surface: the face behind each parent of the overlay
  const std::vector<Index>& walls;  // faces of the surface that are vertical
  const Overlay& overlay;
};

/// The number of the vertex of that height at a place: a point of the overlay, or `none` and where it lies.
using VertexAt = std::function<Index(Index place, Point2 at, double z)>;

/// Appends the parts of the walls inside (or outside) the region to `faces`. A wall is cut at the vertical lines where
/// the edge it stands on was cut, so that it meets the faces beside it; one that stands on no edge where it crosses the
/// border of the region. A part that stands along the border belongs to neither side. Returns how many walls were
/// divided. O(walls + faces of the overlay), and border edges for each wall that stands on no edge.
std::size_t cut_walls(const CutSurface& cut, bool inside, const VertexAt& vertex_at, std::vector<Face>& faces);

}  // namespace terrane
