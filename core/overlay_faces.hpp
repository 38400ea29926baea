// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "core/arrangement.hpp"
#include "core/overlay.hpp"
#include "core/rounding.hpp"

namespace terrane {

/// Triangulated regions of an arrangement, the exterior included, before their rounding is verified.
struct OverlayFaces {
  std::vector<Point2> points;  // per vertex of the arrangement, crossings rounded
  std::vector<Face> faces;     // positive at the exact places
  std::vector<Index> region_of_face;
  std::vector<std::array<Index, 2>> regions;  // parent faces in the completed meshes; none outside the domain
  Index region_count = 0;                     // inside the union of the domains
};

/// Regions inside both domains are triangulated as they are. Ghost edges are no edges of the result: what lies outside
/// one domain is put together again per face of the other and triangulated as a polygon with holes; the exterior
/// likewise. With Refinement::paste B leaves no trace inside A but its vertices on A's border. `exactly`: polygons are
/// triangulated at the exact places of their vertices, which costs microseconds per vertex and is needed only where
/// rounding did harm: on the doubles two polygons could then claim one diagonal.
OverlayFaces faces_of(const Arrangement& arrangement, Refinement refinement, bool exactly, Context& context);

/// Where a crossing lies exactly.
ExactPlace crossing_place(const Arrangement& arrangement, Index vertex);

}  // namespace terrane
