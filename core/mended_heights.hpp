// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/heights.hpp"
#include "core/overlay_faces.hpp"

namespace terrane {

/// Gives the faces that mending changed the heights of continuous input m at their corners. `z`: per vertex; NaN where
/// mending brought a vertex of the outside into the domain, which takes the height of the face. A sliver thinner than
/// rounding may be a cliff, and mending it away lets faces of its two sides meet at one vertex: then the faces on the
/// other side keep their own height there, z becomes one per corner (3 * face + corner), and the result is true.
/// Heights within a micrometre, or 1e-9 of themselves, are no cliff.
bool mend_heights(const OverlayFaces& work, const Array<Point2>& points, const FaceHeights& heights, int m,
                  const std::vector<Index>& relabelled, Array<double>& z);

}  // namespace terrane
