// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/lattice_mesh.hpp"

// Walking over the samples that a lattice triangle covers, and finding the one furthest from a plane.
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

/// max |z[k] - (base + slope * k)| for k < n. Sums and products are the same in every lane and at every n, so that the
/// result is the same on every machine.
template <class T>
inline T worst_in_row(const T* z, T base, T slope, std::int32_t n) {
  constexpr int lanes = 16 / sizeof(T);
  typedef T Lanes __attribute__((vector_size(16)));
  T worst = 0;
  std::int32_t k = 0;
  if (n >= 2 * lanes) {
    Lanes place, high = {}, low = {};
    for (int l = 0; l < lanes; ++l) place[l] = static_cast<T>(l);
    for (; k + lanes <= n; k += lanes) {
      Lanes sample;
      std::memcpy(&sample, z + k, sizeof sample);
      const Lanes error = sample - (base + slope * place);
      high = error > high ? error : high;
      low = error < low ? error : low;
      place += static_cast<T>(lanes);
    }
    for (int l = 0; l < lanes; ++l) worst = std::max(worst, std::max(high[l], -low[l]));
  }
  for (; k < n; ++k) worst = std::max(worst, std::fabs(z[k] - (base + slope * static_cast<T>(k))));
  return worst;
}

/// The k at which worst_in_row found its result.
template <class T>
inline std::int32_t place_in_row(const T* z, T base, T slope, T worst) {
  std::int32_t k = 0;
  while (!(std::fabs(z[k] - (base + slope * static_cast<T>(k))) >= worst)) ++k;
  return k;
}

}  // namespace terrane
