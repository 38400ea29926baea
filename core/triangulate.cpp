// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/triangulate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/error.hpp"
#include "core/lattice/triangulate_greedy.hpp"
#include "core/lattice/triangulate_grid.hpp"
#include "core/shortest.hpp"

namespace terrane {

namespace {

void check_heights(const Raster& dem) {
  const auto wrong =
      std::find_if(dem.samples.begin(), dem.samples.end(), [](double z) { return std::fabs(z) > 1e150; });
  if (wrong == dem.samples.end()) return;
  const auto place = wrong - dem.samples.begin();
  throw Error(ErrorKind::input, "not-finite",
              "the sample in row " + std::to_string(place / dem.width) + ", column " +
                  std::to_string(place % dem.width) + " is no height; declare it as NoData or mend it");
}

}  // namespace

/// Integer geometry carries over to the doubles when a cell is much wider than the spacing of doubles where it lies.
void check_lattice(const Raster& dem) {
  const auto cells = [&](double origin, double cell, int count) {
    const double reach = std::max(std::fabs(origin), std::fabs(origin) + cell * count);
    return cell > 0 && std::isfinite(reach * reach) && reach * 0x1p-52 * 4.0 * (dem.width + dem.height) < 0.25 * cell;
  };
  if (!cells(dem.x0, dem.dx, dem.width) || !cells(dem.y0, dem.dy, dem.height)) {
    throw Error(ErrorKind::input, "cell-size",
                "the cells of the raster (" + shortest(dem.dx) + " x " + shortest(dem.dy) +
                    ") cannot be told apart at its coordinates; check its georeference");
  }
  if (dem.samples.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max()) / 2) {
    throw Error(ErrorKind::limit, "too-many-samples",
                "the raster has " + std::to_string(dem.samples.size()) +
                    " samples, more than a TIN can have vertices for; cut it into tiles");
  }
}

void check_triangulable(const Raster& dem) {
  if (dem.width < 2 || dem.height < 2) return;
  check_lattice(dem);
  check_heights(dem);
}

Triangulated triangulate(const Raster& dem, const TriangulateOptions& options, Context& context) {
  if (dem.width < 2 || dem.height < 2) return {};
  check_triangulable(dem);
  if (options.max_error > 0) return triangulate_greedily(dem, options, context);
  Tin whole = triangulate_every_sample(dem, context);
  if (options.max_triangles > 0 && whole.faces.size() > options.max_triangles) {
    whole = {};
    return triangulate_greedily(dem, options, context);
  }
  return {std::move(whole), 0};
}

}  // namespace terrane
