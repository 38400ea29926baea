// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/mesh/array.hpp"
#include "core/tin.hpp"

namespace terrane {

/// A DEM: heights at cell centres on a north-up lattice. Sample (column i, row j), row 0 in the north, lies at
/// x = x0 + i * dx, y = y0 - j * dy, with dx, dy > 0 (a reader turns other orders around). Voids are NaN.
struct Raster {
  int width = 0, height = 0;
  double x0 = 0, y0 = 0;  // centre of the north-western sample
  double dx = 0, dy = 0;
  Array<double> samples;  // row by row, width * height

  double at(int i, int j) const { return samples[static_cast<std::size_t>(j) * width + i]; }
  Point2 place(int i, int j) const { return {x0 + i * dx, y0 - j * dy}; }
};

/// Joins rasters that lie on one lattice (same cell, whole-cell offsets, both to 1e-6 of a cell) and touch or overlap
/// with equal samples wherever both have one: such tiles are pieces of one raster, and joined they leave no slit.
/// `groups[i]` receives which of the returned rasters raster i went into. Tiles that overlap with different samples are
/// left apart, as are all overlapping tiles when `join_overlaps` is false. The outcome does not depend on the order of
/// `tiles` except that the returned rasters stand in the order of their first members.
std::vector<Raster> join_on_lattice(const std::vector<Raster>& tiles, bool join_overlaps, std::vector<int>& groups);

}  // namespace terrane
