// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/shapes.hpp"
#include "core/zones.hpp"

namespace terrane {

/// The outlines of zones. Returns for zone i its polygons: one for each piece that hangs together by edges, so none
/// where a zone has no face. Outer rings run counter-clockwise, holes clockwise, each begins at its corner lowest in x,
/// then y, and is simple: where a border touches itself in a point the rings on both sides of it end there, as simple
/// features (ISO 19125) want it. z is NaN. O(faces).
std::vector<std::vector<Polygon>> zone_polygons(const ZonedMesh& mesh);

}  // namespace terrane
