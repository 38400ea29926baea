// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "core/overlay.hpp"
#include "core/tin.hpp"

// An independent, slow and exact overlay to compare core/overlay with: CGAL's constrained Delaunay triangulation with
// exact constructions. Shares no code with the core but its types.
namespace terrane::support {

/// The overlay of A and B, points rounded to the nearest doubles. Nothing is mended: faces may be turned over by
/// rounding where features are closer than doubles. Small inputs only (seconds at 2,000 vertices each).
Overlay oracle_overlay(const Tin& a, const Tin& b);

/// What the exact arrangement of the edges of A and B holds inside the union of the domains.
struct OracleCounts {
  std::size_t regions = 0;
  std::size_t vertices = 0;  // of A, of B and crossings, at different exact places
  double area = 0, overlap_area = 0;
};
OracleCounts oracle_counts(const Tin& a, const Tin& b);

/// The height of a TIN at a place by exact barycentric coordinates: the lowest-index face that holds it; NaN outside.
double oracle_height(const Tin& tin, Point2 at);

}  // namespace terrane::support
