// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/arrangement.hpp"

namespace terrane {

/// Heights of one input at the vertices of an arrangement: always convex combinations of its own heights, never
/// extrapolated, so that a vertex a rounding error outside its face cannot run away on a steep sliver's plane.
class SurfaceHeights {
 public:
  SurfaceHeights(const Tin& tin, const Arrangement& arrangement, int m, const std::vector<Point2>& points)
      : tin_(tin), arrangement_(arrangement), mesh_(arrangement.mesh(m)), m_(m), points_(points) {}

  /// `points`: the vertices' doubles; must outlive this.
  /// Of a continuous surface; NaN outside its domain.
  double at_vertex(Index vertex) const;
  /// As the given real face of the completed mesh has it.
  double in_face(Index face, Index vertex) const;
  /// Distance in plan from a point to a real face.
  double distance(Index face, Point2 p) const;

 private:
  double z(Index face, int corner) const { return tin_.vertices[mesh_.vertex[3 * face + corner]].z; }
  double on_edge(Index h, Point2 p) const;  // h of a real face
  double on_plane(Index face, Point2 p) const;
  /// A real half-edge of the edge, or none.
  Index real_half(Index e) const;

  const Tin& tin_;
  const Arrangement& arrangement_;
  const CompletedMesh& mesh_;
  int m_;
  const std::vector<Point2>& points_;
};

}  // namespace terrane
