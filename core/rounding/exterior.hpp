// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "core/rounding/rounding.hpp"

namespace terrane {

/// Fills the plane around a connected mesh, out to a box, with faces of label none, positive at the exact places: what
/// rounding moves past the border then meets what lies beyond. The corners of the box become the last points. Does
/// nothing when the border does not bound at the exact places. O(n + b log b), b border edges.
void add_exterior(PlanarMesh& mesh, const std::function<ExactPlace(Index)>& place);

}  // namespace terrane
