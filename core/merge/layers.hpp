// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/context.hpp"
#include "core/overlay.hpp"
#include "core/tin.hpp"

namespace terrane {

/// The height of one tile at the corners of a face.
struct Layer {
  int tile;  // its rank in the order of the merge
  double z[3];
  std::uint8_t firm[3];  // whether it is the height of a vertex of the tile
  Index face = none;     // of the tile without its walls
  double slope = 0;      // of that face
};

/// The common refinement of any number of tiles in plan, with the heights of all tiles on every face.
struct Layered {
  Array<Point2> points;
  Array<Face> faces;
  std::vector<std::size_t> first;  // layers of face f: first[f] to first[f + 1], by rising tile
  std::vector<Layer> layers;

  std::span<Layer> of(std::size_t f) { return {&layers[first[f]], first[f + 1] - first[f]}; }
  std::span<const Layer> of(std::size_t f) const { return {&layers[first[f]], first[f + 1] - first[f]}; }
};

/// Overlays the tiles (rank by rank: tiles[order[rank]]) in plan, as merge() does, and reads every height off the
/// tile's own face: vertices of a tile keep their heights bit for bit, and where a tile is continuous its faces agree
/// about the height of a place. O(n log n) in input and output.
Layered layers_of(const std::vector<Tin>& tiles, const std::vector<int>& order, RoundingReport& report,
                  Context& context);

}  // namespace terrane
