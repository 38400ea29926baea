// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/triangulate.hpp"

#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/triangulate_grid.hpp"

namespace terrane {

namespace {

/// Integer geometry carries over to the doubles when a cell is much wider than the spacing of doubles where it lies.
void check_lattice(const Raster& dem) {
  const auto cells = [](double origin, double cell, int count) {
    const double reach = std::max(std::fabs(origin), std::fabs(origin) + cell * count);
    return std::isfinite(reach) && cell > 0 && reach * 0x1p-52 * (4.0 * count + 4) < 0.25 * cell;
  };
  if (!cells(dem.x0, dem.dx, dem.width + dem.height) || !cells(dem.y0, dem.dy, dem.width + dem.height)) {
    throw Error(ErrorKind::input, "cell-size",
                "the cells of the raster (" + std::to_string(dem.dx) + " x " + std::to_string(dem.dy) +
                    ") are too small to be told apart at its coordinates; check its georeference");
  }
  if (dem.samples.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max()) / 2) {
    throw Error(ErrorKind::limit, "too-many-samples", "the raster has " + std::to_string(dem.samples.size()) +
                                                          " samples, more than a TIN can have faces; cut it into tiles");
  }
}

}  // namespace

Triangulated triangulate(const Raster& dem, const TriangulateOptions& options, Context& context) {
  if (dem.width < 2 || dem.height < 2) return {};
  check_lattice(dem);
  (void)options;
  return {triangulate_every_sample(dem, context), 0};
}

}  // namespace terrane
