// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "core/context.hpp"
#include "core/raster.hpp"
#include "core/tin.hpp"

namespace terrane {

/// Refuses heights and cells that no TIN can hold in doubles. Readers ask too, for they know the name of the input.
void check_triangulable(const Raster& dem);
/// Refuses cells alone, also of rasters a sample wide, of which no TIN is made.
void check_lattice(const Raster& dem);

struct TriangulateOptions {
  double max_error = 0;           // vertical bound at every sample, in the raster's height unit; 0 = every sample a vertex
  std::size_t max_triangles = 0;  // 0 = no limit; stops greedy insertion early, the error reached is reported
};

struct Triangulated {
  Tin tin;
  double error = 0;  // the largest |sample - surface| over every sample of the domain, measured on the result
};

/// A TIN of a raster, nowhere further than max_error (vertically) from its samples.
/// Domain: the cells whose four corner samples exist, and of cells with three the one triangle that exists: voids are holes.
/// max_error = 0: every sample of the domain is a vertex, every cell cut by the diagonal with the smaller height difference,
/// lower-left to upper-right on ties. max_error > 0: greedy insertion into a Delaunay triangulation constrained by the
/// domain's border (Garland & Heckbert 1995), the border itself simplified run by run within the same bound and from the
/// run's samples alone, so that tiles with a shared edge of samples meet vertex on vertex.
/// O(s) for max_error = 0; about O(s log n) for s samples and n vertices otherwise.
/// Rasters that `check_triangulable` refuses are refused.
Triangulated triangulate(const Raster& dem, const TriangulateOptions& options, Context& context);

}  // namespace terrane
