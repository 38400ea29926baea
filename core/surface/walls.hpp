// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/surface.hpp"

namespace terrane {

/// The TIN of a corner surface whose heights are closed: equal heights at a place are equal doubles, and no jump
/// changes sign along an edge. Walls, when wanted, are cut at every height of their places, so vertical edges conform.
/// `neighbours` as in PlanarMesh. Not canonical. O(n).
struct Walled {
  Tin tin;
  double wall_area = 0;
};
Walled raise(const CornerSurface& surface, const Array<Face>& neighbours, bool walls);

}  // namespace terrane
