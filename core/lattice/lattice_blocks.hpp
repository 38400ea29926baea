// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/lattice/lattice_mesh.hpp"

namespace terrane {

/// How a lattice is cut into blocks, from its size alone.
struct LatticeGrid {
  int width = 0, height = 0;  // samples
  int columns = 1, rows = 1;  // blocks
};

/// A mesh cut along edges into blocks, each a mesh of its own that can be refined apart from the others. The block of a
/// triangle is where its centroid lies. Edges between blocks are seams: both sides keep them whole.
class LatticeBlocks {
 public:
  std::vector<LatticeMesh> blocks;

  LatticeBlocks(LatticeMesh whole, const LatticeGrid& grid);

  /// The blocks as one mesh, Delaunay across the seams too. Triangles come block by block; the vertices of `whole` keep
  /// their numbers. To be called once.
  LatticeMesh join();

 private:
  LatticeMesh whole_;
  std::vector<std::vector<Index>> vertex_;  // of each block: numbers in `whole` of the vertices it was cut
                                            // out with
};

}  // namespace terrane
