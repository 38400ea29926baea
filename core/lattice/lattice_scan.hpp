// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include "core/lattice/lattice_mesh.hpp"

// Walking over the samples that a lattice triangle covers, and finding the largest of their errors.
namespace terrane {

/// An upward lattice edge, followed row by row; exact.
class EdgeWalk {
 public:
  EdgeWalk(LatticePoint low, LatticePoint high) : x_(low.x), height_(high.y - low.y) {
    if (height_ == 0) return;
    const std::int32_t width = high.x - low.x;
    step_ = width / height_;
    part_ = width % height_;
    if (part_ < 0) part_ += height_, --step_;
  }
  void step() {
    x_ += step_;
    rest_ += part_;
    if (rest_ >= height_) rest_ -= height_, ++x_;
  }
  /// The first sample right of the edge, those on it counted or not.
  std::int32_t first(bool inclusive) const { return inclusive && rest_ == 0 ? x_ : x_ + 1; }
  /// The last sample left of the edge, those on it counted or not.
  std::int32_t last(bool inclusive) const { return inclusive || rest_ != 0 ? x_ : x_ - 1; }

 private:
  std::int32_t x_, height_, step_ = 0, part_ = 0, rest_ = 0;
};

/// Calls visit(y, first, last) for the rows of samples in a counter-clockwise triangle, first <= last, upwards; never a
/// corner. inclusive[k]: samples on the edge opposite corner k count.
template <class Visit>
inline void for_each_row(const std::array<LatticePoint, 3>& p, const std::array<bool, 3>& inclusive, Visit visit) {
  int b = 0, m = 1, t = 2;
  if (p[m].y < p[b].y) std::swap(b, m);
  if (p[t].y < p[b].y) std::swap(t, b);
  if (p[t].y < p[m].y) std::swap(t, m);
  const auto row = [&](std::int32_t y, std::int32_t first, std::int32_t last) {
    if (first <= last) visit(y, first, last);
  };
  const bool on_long = inclusive[m];
  const bool short_is_left = area2(p[b], p[t], p[m]) > 0;
  EdgeWalk along(p[b], p[t]);
  const auto between = [&](EdgeWalk& side, bool on_side, std::int32_t y) {
    if (short_is_left) {
      row(y, side.first(on_side), along.last(on_long));
    } else {
      row(y, along.first(on_long), side.last(on_side));
    }
  };
  std::int32_t y = p[b].y;
  if (p[m].y == y) {
    if (inclusive[t]) row(y, std::min(p[b].x, p[m].x) + 1, std::max(p[b].x, p[m].x) - 1);
  } else {
    EdgeWalk side(p[b], p[m]);
    for (++y; y < p[m].y; ++y) {
      side.step();
      along.step();
      between(side, inclusive[t], y);
    }
    if (p[m].y < p[t].y) {
      along.step();
      if (short_is_left) {
        row(y, p[m].x + 1, along.last(on_long));
      } else {
        row(y, along.first(on_long), p[m].x - 1);
      }
    }
  }
  if (p[m].y == p[t].y) {
    if (inclusive[b]) row(y, std::min(p[t].x, p[m].x) + 1, std::max(p[t].x, p[m].x) - 1);
    return;
  }
  EdgeWalk side(p[m], p[t]);
  for (++y; y < p[t].y; ++y) {
    side.step();
    along.step();
    between(side, inclusive[b], y);
  }
}

/// The largest error over rows of samples, and the first row that has it. Errors come in lanes, each a sample's own, so
/// that the outcome is the same on every machine.
template <class T>
class Furthest {
 public:
  static constexpr int lanes = 16 / sizeof(T);
  using Integer = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;
  typedef T Lanes __attribute__((vector_size(16)));
  typedef Integer Mask __attribute__((vector_size(16)));

  static Lanes load(const T* from) {
    Lanes lanes;
    std::memcpy(&lanes, from, sizeof lanes);
    return lanes;
  }
  static Lanes absolute(Lanes x) {
    return std::bit_cast<Lanes>(std::bit_cast<Mask>(x) & std::numeric_limits<Integer>::max());
  }

  /// Rows must come in ascending order.
  void add(Lanes error, Mask counts, Integer row) {
    const Mask larger = (error > error_) & counts;
    error_ = larger ? error : error_;
    row_ = larger ? Mask{} + row : row_;
  }

  T error() const {
    T worst = 0;
    for (int l = 0; l < lanes; ++l) worst = std::max(worst, error_[l]);
    return worst;
  }
  std::int32_t row() const {
    const T worst = error();
    Integer row = std::numeric_limits<Integer>::max();
    for (int l = 0; l < lanes; ++l) {
      if (error_[l] == worst) row = std::min(row, row_[l]);
    }
    return static_cast<std::int32_t>(row);
  }

 private:
  Lanes error_{};
  Mask row_{};
};

}  // namespace terrane
