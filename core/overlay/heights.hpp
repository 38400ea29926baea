// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/overlay/arrangement.hpp"
#include "core/overlay/mended_heights.hpp"

namespace terrane {

/// Fills points and heights of the vertices that are places, as locate_places() found them.
void place_vertices(Arrangement& arrangement, Context& context);

/// Heights of one input on a given face, for surfaces that jump and vertices that rounding moved out of their face.
class FaceHeights {
 public:
  FaceHeights(const Tin& tin, const Arrangement& arrangement, int m)
      : tin_(tin), arrangement_(arrangement), mesh_(*arrangement.mesh[m]), m_(m) {}

  /// At a vertex that lies at `p`, as the given real face of the completed mesh has it.
  double at(Index face, Index vertex, Point2 p) const;
  /// See height_error.
  HeightError error(Index face, double max_move) const;
  /// Distance in plan from a point to a real face.
  double distance(Index face, Point2 p) const;

 private:
  double z(Index face, int corner) const { return tin_.vertices[tin_.faces[mesh_.tin_face(face)][corner]].z; }

  const Tin& tin_;
  const Arrangement& arrangement_;
  const CompletedMesh& mesh_;
  int m_;
};

}  // namespace terrane
