// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/tin.hpp"

namespace terrane {

/// Finds the segments near a place: a grid of square cells about as wide as the segments are long, each listing those
/// that pass through it or through a neighbour. O(segments) to build; a question costs what it finds.
class SegmentIndex {
 public:
  /// `reach`: how large, about, the boxes asked for are.
  SegmentIndex(std::vector<std::array<Point2, 2>> segments, double reach);

  /// Numbers of segments whose box meets the box, rising, each once. `found` is replaced.
  void near(const Box& box, std::vector<Index>& found) const;

  const std::array<Point2, 2>& operator[](Index i) const { return segments_[i]; }
  std::size_t size() const { return segments_.size(); }
  double cell_size() const { return size_; }

 private:
  std::uint64_t cell(std::int64_t column, std::int64_t row) const {
    return static_cast<std::uint64_t>(column) * 0x9e3779b97f4a7c15u ^ static_cast<std::uint64_t>(row);
  }
  std::int64_t at(double v, double origin) const;

  std::vector<std::array<Point2, 2>> segments_;
  Point2 origin_;
  double size_ = 1;
  std::unordered_map<std::uint64_t, std::vector<Index>> cells_;
};

}  // namespace terrane
