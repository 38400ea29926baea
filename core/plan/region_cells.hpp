// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/plan_region.hpp"

namespace terrane {

/// A coarse map of a region: tells of nearly every face of a surface, without looking at an edge, on which side of the
/// border it lies.
class RegionCells {
 public:
  enum class Where : std::uint8_t { outside, inside, near };

  /// About `cells` cells, at least 64 and at most 4 million, over what the region's box and `within` have in common:
  /// only boxes inside `within` may be asked for. Precondition: the region is not empty, and they have something in
  /// common. O(cells + border edges + cells they pass).
  RegionCells(const PlanRegion& region, const Box& within, std::size_t cells);

  /// Where a closed box lies; near: the border may touch it. O(1).
  Where operator()(const Box& box) const;

 private:
  int column(double x) const;
  int row(double y) const;
  void mark(Point2 p, Point2 q);
  void count_marks();
  void label(const PlanRegion& region);

  Box box_;
  double cell_ = 1;
  int columns_ = 1, rows_ = 1;
  std::vector<std::uint8_t> inside_;   // of a cell that the border does not touch
  std::vector<std::uint32_t> marked_;  // marks in the cells below and to the left, per corner of cells
};

}  // namespace terrane
