// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/triangulate.hpp"

namespace terrane {

/// Greedy insertion; see core/triangulate.hpp. The raster is at least 2 x 2 and all its samples are finite or NaN.
Triangulated triangulate_greedily(const Raster& dem, const TriangulateOptions& options, Context& context);

}  // namespace terrane
