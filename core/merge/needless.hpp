// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <unordered_map>

#include "core/mosaic.hpp"

// A merge overlays one tile after the other. Edges that only triangulate what lies on one plane are edges like any
// other to the next tile, and every crossing with one leaves a vertex and more such edges: without taking them out
// again, tiles that lie on each other a little shifted grow by half with every tile.
namespace terrane {

/// Numbers for what lies on the same faces of the same tiles (Piece::cells).
class Cells {
 public:
  Index fresh() { return count_++; }
  /// Of what lies in both; one number for one pair.
  Index both(Index a, Index b) {
    const auto key = static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32 | static_cast<std::uint32_t>(b);
    const auto [it, is_new] = made_.try_emplace(key, count_);
    if (is_new) ++count_;
    return it->second;
  }

 private:
  Index count_ = 0;
  std::unordered_map<std::uint64_t, Index> made_;
};

/// The result of laying `tile` over `near` without the vertices that this made and no cell needs: inside a cell, or on
/// the straight border, within `tolerance` in plan, of two (or of one and the outside). What is left keeps its place
/// and heights; faces stay strictly positive and conform. Needs the cells of all three. Faces may change their order,
/// which is again the same for any. O(n log n).
Piece without_needless(Piece piece, const Piece& near, const Piece& tile, double tolerance);

}  // namespace terrane
