// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "core/overlay/arrangement.hpp"

namespace terrane {

/// Triangulated regions of an arrangement before their rounding is verified. Faces of one region are consecutive and
/// have the same parents, which no other region has; the exterior is the last one.
struct OverlayFaces {
  Array<Face> faces;                    // counter-clockwise at the exact places
  Array<std::array<Index, 2>> parents;  // faces of the completed meshes; none outside the domain
  std::size_t exterior = 0;             // faces from here on lie outside both domains
  Index regions = 0;                    // inside the union of the domains
  bool all_positive = true;             // every face is, exactly, on the doubles
};

/// Regions inside both domains are triangulated as they are. Ghost edges are no edges of the result: what lies outside
/// one domain is put together again per face of the other and triangulated as a polygon with holes; the exterior
/// likewise. With Refinement::paste B leaves no trace inside A but its vertices on A's border; with Refinement::outline
/// B's inner edges are treated as ghost edges are, and its faces as one, number 0. What is put together is
/// first triangulated on the doubles, and, when a face is not positive then, at the exact places, which costs
/// microseconds per vertex: on the doubles two polygons could claim one diagonal. The same for any number of threads.
OverlayFaces faces_of(const Arrangement& arrangement, Refinement refinement, Context& context);

}  // namespace terrane
