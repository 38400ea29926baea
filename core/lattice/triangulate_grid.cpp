// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/lattice/triangulate_grid.hpp"

#include <cmath>

namespace terrane {

namespace {

/// Calls triangle(a, b, c) for the one or two triangles of the cell south-east of sample (i, j), corners as sample
/// numbers.
template <class Triangle>
inline void cut_cell(const Raster& dem, int i, int j, Triangle triangle) {
  const std::size_t ul = static_cast<std::size_t>(j) * dem.width + i, ur = ul + 1, ll = ul + dem.width, lr = ll + 1;
  const double z_ul = dem.samples[ul], z_ur = dem.samples[ur], z_ll = dem.samples[ll], z_lr = dem.samples[lr];
  const double rising = std::fabs(z_ll - z_ur), falling = std::fabs(z_lr - z_ul);
  if (rising <= falling) {
    triangle(ll, lr, ur);
    triangle(ll, ur, ul);
  } else if (falling < rising) {
    triangle(ul, ll, lr);
    triangle(ul, lr, ur);
  } else if (std::isnan(rising) && !std::isnan(falling)) {  // the void is on the rising diagonal
    if (!std::isnan(z_ll)) triangle(ul, ll, lr);
    if (!std::isnan(z_ur)) triangle(ul, lr, ur);
  } else if (std::isnan(falling) && !std::isnan(rising)) {
    if (!std::isnan(z_lr)) triangle(ll, lr, ur);
    if (!std::isnan(z_ul)) triangle(ll, ur, ul);
  }
}

}  // namespace

Tin triangulate_every_sample(const Raster& dem, Context& context) {
  Tin tin;
  std::vector<Index> vertex(dem.samples.size(), none);
  std::size_t faces = 0;
  for (int j = 0; j + 1 < dem.height; ++j) {
    for (int i = 0; i + 1 < dem.width; ++i) {
      cut_cell(dem, i, j, [&](std::size_t a, std::size_t b, std::size_t c) {
        vertex[a] = vertex[b] = vertex[c] = 0;
        ++faces;
      });
    }
  }
  std::size_t vertices = 0;
  for (Index& v : vertex) {
    if (v != none) v = static_cast<Index>(vertices++);
  }
  tin.vertices.reserve(vertices);
  tin.faces.reserve(faces);
  for (int j = 0; j < dem.height; ++j) {
    if (j % 64 == 0) context.progress("triangulate", static_cast<double>(j) / dem.height);
    for (int i = 0; i < dem.width; ++i) {
      if (vertex[static_cast<std::size_t>(j) * dem.width + i] == none) continue;
      const Point2 p = dem.place(i, j);
      tin.vertices.push_back({p.x, p.y, dem.at(i, j)});
    }
    if (j + 1 == dem.height) continue;
    for (int i = 0; i + 1 < dem.width; ++i) {
      cut_cell(dem, i, j, [&](std::size_t a, std::size_t b, std::size_t c) {
        tin.faces.push_back({vertex[a], vertex[b], vertex[c]});
      });
    }
  }
  return tin;
}

}  // namespace terrane
