// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/lattice/lattice_mesh.hpp"
#include "core/raster.hpp"

namespace terrane {

/// The border of a raster's domain (see core/triangulate.hpp) on the lattice, y = height - 1 - row.
struct LatticeBorder {
  std::vector<LatticePoint> points;  // each once, along the border lines
  std::vector<LatticeEdge> edges;
};

/// The border with straight runs along rows and columns thinned: every sample of a run lies within `tolerance` of the
/// line between the kept ones (Douglas & Peucker 1973), decided from the run alone. Along the outermost rows and
/// columns the run is that of existing samples, wherever the domain behind it ends, so that a neighbour that shares it
/// decides alike. Corners, places where the border touches itself and diagonal edges are kept. tolerance < 0: only
/// those are kept. O(s), and O(n log n) expected for runs of n.
LatticeBorder find_border(const Raster& dem, double tolerance);

}  // namespace terrane
