// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "core/context.hpp"
#include "core/rounding/rounding.hpp"
#include "core/tin.hpp"

// New vertices where a linear function is zero along edges of a conforming triangulation: where heights cross along a
// seam, and where two surfaces cross.
namespace terrane {

/// Asks for a vertex on the edge of `face` opposite corner `side`, where a function linear along it is zero.
struct EdgeCut {
  Index face;
  int side;
  double dp, dq;  // the function at corners side + 1 and side + 2, of opposite sign
};

/// A vertex made on an edge. Ends in the order of their places, so both faces interpolate alike.
struct CutVertex {
  Index p, q;
  double dp, dq;
  Index owners[2];  // the faces that asked for it; the second is `none` unless both sides meant the same place
};

/// Whether faces are also divided along the line between the vertices they asked for.
enum class Chords { none, between_own_cuts };

struct CutMesh {
  PlanarMesh mesh;  // labels[f]: the face of before that f lies on; no dead faces
  std::vector<CutVertex> made;
  Index first_made = 0;  // made[i] is vertex first_made + i
  Rounded rounded;
};

/// Cuts the faces of a triangulation at vertices on their edges; both faces at an edge receive them. With chords a face
/// that asked for two vertices is divided between them, one that asked for one between it and the opposite corner.
/// Rounded and verified. O(faces + cuts log cuts).
CutMesh cut_edges(PlanarMesh mesh, const std::vector<EdgeCut>& cuts, Chords chords, Context& context);

/// The last step of every way of cutting: rounds and verifies a mesh whose vertices from `first_made` on were made on
/// edges and lie at `place`; labels and distances as in round_and_verify. The exterior has a say where a vertex may
/// pass the border. Dead faces are left out, neighbours are up to date.
Rounded round_cuts(PlanarMesh& mesh, Index first_made, const std::function<ExactPlace(Index)>& place,
                   const std::function<double(Index label, Point2)>& distance, Context& context);

/// Is v a corner of `face`, a face of before, or made on one of its edges?
bool is_on(const CutMesh& cut, const Face& face, Index v);

/// The value at vertex v of the cut mesh of a function given by its values at the corners of `face`, a face of before:
/// interpolated along the edge for a vertex made on it, inside the face for a vertex that rounding brought there.
double value_on(const CutMesh& cut, const Array<Point2>& points, const Face& face, const double* values, Index v);

}  // namespace terrane
