// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

namespace terrane {

/// Levels from the lowest up, as they stand in a list of any order.
class LevelOrder {
 public:
  explicit LevelOrder(std::span<const double> levels) : levels_(levels), order_(levels.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    std::stable_sort(order_.begin(), order_.end(), [&](auto i, auto j) { return levels_[i] < levels_[j]; });
  }
  std::size_t size() const { return order_.size(); }
  double operator[](std::size_t i) const { return levels_[order_[i]]; }
  std::size_t in_list(std::size_t i) const { return order_[i]; }

  /// Where heights from `low` to `high` lie: as a whole above the first `first` levels, by at least the tolerance, and
  /// as a whole below those from `last` on.
  struct Span {
    std::size_t first, last;
  };
  Span span(double low, double high, double tolerance) const {
    const auto count = [&](const auto& is) {
      return static_cast<std::size_t>(
          std::partition_point(order_.begin(), order_.end(), [&](auto i) { return is(levels_[i]); }) - order_.begin());
    };
    return {count([&](double l) { return low - l >= tolerance && high - l > tolerance; }),
            count([&](double l) { return !(l - high >= tolerance && l - low > tolerance); })};
  }

 private:
  std::span<const double> levels_;
  std::vector<std::size_t> order_;
};

}  // namespace terrane
