// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.hpp"
#include "core/rasterize.hpp"
#include "core/ticks.hpp"
#include "core/validate.hpp"
#include "ops/grid.hpp"
#include "ops/inputs.hpp"
#include "ops/memory.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"

namespace terrane {
namespace {

constexpr double most_samples = 400e6;  // 8 bytes each; as many as a reader takes
constexpr double most_unasked = 25e6;   // where nobody said how large the cells are to be

struct RasterizeParameters {
  std::string cell_size;
  std::vector<double> bbox;
  std::optional<long> width, height;

  void visit(Fields& f) {
    f.text("cell-size", cell_size,
           "The side of a cell, in CRS units or with one of the units m, ft, ftUS. Where coordinates are degrees, "
           "0.001deg, or a length: then the largest of 1, 2 or 5 x 10^-n degrees within it. Left out: about as far as "
           "the surface's points are apart.");
    f.numbers("bbox", bbox,
              "xmin,ymin,xmax,ymax in the result's CRS: the outer edges of the raster, of the last cells at least. "
              "Left out: all of the surface, out to multiples of the cell size.");
    f.integer("width", width, {.minimum = 1, .maximum = 2e9}, "Columns, instead of a cell size.");
    f.integer("height", height, {.minimum = 1, .maximum = 2e9},
              "Rows, instead of a cell size; with width, cells may be oblong.");
  }
};

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorKind::usage, "bad-parameter", what); }

/// A side of a cell as it was asked for.
struct CellSize {
  double degrees = 0;  // where it was said in these
  Length length;

  static CellSize parse(const std::string& text) {
    CellSize size;
    if (text.ends_with("deg")) {
      const auto degrees = parse_number(std::string_view(text).substr(0, text.size() - 3));
      if (!degrees) refuse("parameter 'cell-size' is '" + text.substr(0, 80) + "'; it takes a number before deg");
      size.degrees = *degrees;
    } else {
      size.length = Length::parse(text, "cell-size");
    }
    const double value = size.degrees + size.length.value;
    if (!(value > 0 && value <= largest_coordinate)) refuse("parameter 'cell-size' must be above 0, and at most 1e100");
    return size;
  }

  double in(const Crs& crs) const {
    const bool in_degrees = crs.known() && crs.geographic();
    if (degrees > 0 && !in_degrees) refuse("the result's coordinates are no degrees; give cell-size as a length");
    return degrees > 0 ? degrees : grid_step(length, crs);
  }
};

void check(const nlohmann::json& values, const std::vector<InputPart>& inputs) {
  const auto p = filled<RasterizeParameters>(values);
  const bool like = std::any_of(inputs.begin(), inputs.end(), [](const InputPart& i) { return i.slot == "like"; });
  if (!p.cell_size.empty()) CellSize::parse(p.cell_size);
  if (!p.bbox.empty() && !(p.bbox.size() == 4 && p.bbox[0] < p.bbox[2] && p.bbox[1] < p.bbox[3]))
    refuse("parameter 'bbox' takes xmin,ymin,xmax,ymax, with xmin < xmax and ymin < ymax");
  for (const double edge : p.bbox)
    if (!(std::fabs(edge) <= largest_coordinate)) refuse("parameter 'bbox' takes coordinates up to 1e100");
  if (like && (!p.cell_size.empty() || !p.bbox.empty() || p.width || p.height))
    refuse("'like' says which cells the result has; cell-size, bbox, width and height cannot say so too");
  if (!p.cell_size.empty() && (p.width || p.height)) refuse("give either cell-size, or width and height");
}

std::string shortest(double value) { return nlohmann::json(value).dump(); }

/// Cells that begin at the west and north of a box and cover it.
struct Grid {
  double west = 0, north = 0, dx = 0, dy = 0, columns = 0, rows = 0;
};

/// As many cells as cover an extent; what rounding adds to a whole number of them is none.
double cells_over(double extent, double cell) { return std::max(1.0, std::ceil(extent / cell - 1e-6)); }

Grid grid_over(const Box& box, double cell, bool given) {
  if (given)
    return {
        box.xmin, box.ymax, cell, cell, cells_over(box.xmax - box.xmin, cell), cells_over(box.ymax - box.ymin, cell)};
  // Lines of the grid at multiples of the cell.
  const double west = std::floor(box.xmin / cell), east = std::max(west + 1, std::ceil(box.xmax / cell));
  const double south = std::floor(box.ymin / cell), north = std::max(south + 1, std::ceil(box.ymax / cell));
  return {west * cell, north * cell, cell, cell, east - west, north - south};
}

Grid grid_of(const Box& box, const RasterizeParameters& p) {
  const double wide = box.xmax - box.xmin, high = box.ymax - box.ymin;
  if (!(wide > 0 && high > 0)) refuse("the surface has no extent to divide by width and height; give bbox");
  const double dx = p.width ? wide / static_cast<double>(*p.width) : high / static_cast<double>(*p.height);
  const double dy = p.height ? high / static_cast<double>(*p.height) : dx;
  return {box.xmin,
          box.ymax,
          dx,
          dy,
          p.width ? static_cast<double>(*p.width) : cells_over(wide, dx),
          p.height ? static_cast<double>(*p.height) : cells_over(high, dy)};
}

/// A round side about as long as the points of the surface are apart, but not for more cells than anyone wants unasked.
double own_cell(const Tin& tin, const Box& box) {
  double area = 0;
  for (const Face& f : tin.faces) {
    const Point &a = tin.vertices[f[0]], &b = tin.vertices[f[1]], &c = tin.vertices[f[2]];
    area += std::fabs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
  }
  const double all = (box.xmax - box.xmin) * (box.ymax - box.ymin);
  const double apart =
      std::max(std::sqrt(2 * area / static_cast<double>(tin.faces.size())), std::sqrt(all / most_unasked));
  if (!(apart > 0) || !std::isfinite(apart)) refuse("the surface has no area; give cell-size and bbox");
  return round_down(apart * (1 + 1e-9));
}

/// The samples of a grid. Refused before memory is taken where there are too many.
Raster lattice_of(const Grid& grid) {
  if (!(grid.columns * grid.rows <= most_samples) || grid.columns > 2e9 || grid.rows > 2e9) {
    char count[64];
    std::snprintf(count, sizeof count, "%.10g x %.10g", grid.columns, grid.rows);
    throw Error(ErrorKind::limit, "too-many-samples",
                std::string("the raster would have ") + count + " samples of " + shortest(grid.dx) + " x " +
                    shortest(grid.dy) +
                    ", and at most 400000000 are made; choose larger cells (cell-size) or a part (bbox)");
  }
  Raster lattice;
  lattice.width = static_cast<int>(grid.columns);
  lattice.height = static_cast<int>(grid.rows);
  lattice.dx = grid.dx, lattice.dy = grid.dy;
  lattice.x0 = grid.west + grid.dx / 2;
  lattice.y0 = grid.north - grid.dy / 2;
  return lattice;
}

Raster lattice_for(const Surface& surface, const RasterizeParameters& p, Context& context) {
  const Box box = p.bbox.empty() ? bounds(surface.tin()) : Box{p.bbox[0], p.bbox[1], p.bbox[2], p.bbox[3]};
  if (p.width || p.height) return lattice_of(grid_of(box, p));
  if (!p.cell_size.empty())
    return lattice_of(grid_over(box, CellSize::parse(p.cell_size).in(surface.crs), !p.bbox.empty()));
  const double cell = own_cell(surface.tin(), box);
  context.warn({"cell-size-chosen", surface.name, "",
                "no cell-size was given; the cells are " + shortest(cell) + " wide, about as far as points of '" +
                    surface.name + "' are apart",
                "give cell-size, width and height, or a raster 'like'"});
  return lattice_of(grid_over(box, cell, !p.bbox.empty()));
}

Raster heights_at(const Surface& surface, Raster lattice, Context& context) {
  try {
    return rasterize(surface.tin(), std::move(lattice), context);
  } catch (const Error& error) {
    if (error.code != "cell-size") throw;
    refuse("the cells are too small or too large to be told apart at these coordinates; choose another cell-size or bbox");
  }
}

Outcome run(std::vector<Surface>& inputs, const RasterizeParameters& p, Context& context) {
  const Surface& surface = input(inputs, "surface");
  const Surface* like = find_input(inputs, "like");
  const Raster& cells = like ? std::get<Raster>(like->value) : lattice_for(surface, p, context);
  const std::uint64_t count = static_cast<std::uint64_t>(cells.width) * static_cast<std::uint64_t>(cells.height);
  require_memory(address_space().now, count, "cells", memory_figures("rasterize").cell);
  Raster raster = heights_at(surface, cells, context);
  const auto voids =
      std::count_if(raster.samples.begin(), raster.samples.end(), [](double z) { return std::isnan(z); });
  if (voids == static_cast<std::ptrdiff_t>(raster.samples.size()))
    context.warn({"no-overlap", surface.name, "", "no cell has its centre on '" + surface.name + "': all are NoData",
                  "check bbox, 'like' and the CRSs"});
  Outcome outcome;
  outcome.certificate["raster"] = {{"width", raster.width},
                                   {"height", raster.height},
                                   {"cell_size", {raster.dx, raster.dy}},
                                   {"north_west_sample", {raster.x0, raster.y0}},
                                   {"voids", voids},
                                   {"crs", surface.crs.known() ? surface.crs.id() : ""}};
  outcome.result = std::move(raster);
  return outcome;
}

}  // namespace

Operation rasterize_operation() {
  return operation<RasterizeParameters>(
      {.id = "rasterize",
       .title = "Make a raster of a surface",
       .description = "The heights of a surface at the centres of cells, as doubles; NoData (-9999) where there is no "
                      "surface, the "
                      "upper face at a wall. Edges of cells lie at multiples of the cell size unless bbox or 'like' "
                      "say otherwise.",
       .inputs = {{"surface", 1, 1, false, "The surface: a TIN or a raster."},
                  {"like", 0, 1, false, "A raster whose cells and CRS the result has.", "", true}},
       .result = ResultKind::raster,
       .check = check},
      run);
}

}  // namespace terrane
