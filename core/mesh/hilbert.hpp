// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/tin.hpp"

// The Hilbert curve through the square around a box: places near each other on it are near each other in plan.
namespace terrane {

/// Four levels of the Hilbert curve at a time: state (0..3) and four bits of x and of y give eight bits of the key and
/// the next state. Bit 0 of a state: x and y swapped; bit 1: both mirrored.
struct HilbertTable {
  std::uint8_t key[4][256] = {};
  std::uint8_t next[4][256] = {};

  constexpr HilbertTable() {
    for (int state = 0; state < 4; ++state) {
      for (int xy = 0; xy < 256; ++xy) {
        int s = state, k = 0;
        for (int level = 3; level >= 0; --level) {
          int x = (xy >> (4 + level)) & 1, y = (xy >> level) & 1;
          if (s & 2) x ^= 1, y ^= 1;
          if (s & 1) std::swap(x, y);
          k = 4 * k + ((3 * x) ^ y);
          if (y == 0) s ^= x ? 3 : 1;
        }
        key[state][xy] = static_cast<std::uint8_t>(k);
        next[state][xy] = static_cast<std::uint8_t>(s);
      }
    }
  }
};

/// Where on the curve a place is: of 2^32 cells along each side of the square. Equal places have equal keys. Never
/// undefined, whatever the numbers.
class HilbertCurve {
 public:
  explicit HilbertCurve(const Box& box)
      : x_(box.xmin),
        y_(box.ymin),
        half_extent_(std::max(0.5 * box.xmax - 0.5 * box.xmin, 0.5 * box.ymax - 0.5 * box.ymin)) {}

  std::uint64_t key(double px, double py) const { return upper_key<64>(px, py); }

  /// The key with all but its upper bits, a multiple of 8 of them, zero.
  template <int bits>
  std::uint64_t upper_key(double px, double py) const {
    static_assert(bits % 8 == 0 && bits > 0 && bits <= 64);
    const std::uint32_t x = cell(px, x_), y = cell(py, y_);
    std::uint64_t key = 0;
    int state = 0;
    for (int shift = 28; shift >= 32 - bits / 2; shift -= 4) {
      const int xy = static_cast<int>((x >> shift & 15) << 4 | (y >> shift & 15));
      key = key << 8 | table.key[state][xy];
      state = table.next[state][xy];
    }
    return key << (64 - bits);
  }

 private:
  static constexpr HilbertTable table{};

  std::uint32_t cell(double v, double low) const {
    const double t = (0.5 * v - 0.5 * low) / half_extent_;
    if (!(t > 0)) return 0;
    return t >= 1 ? std::numeric_limits<std::uint32_t>::max() : static_cast<std::uint32_t>(t * 4294967295.0);
  }

  double x_, y_, half_extent_;
};

}  // namespace terrane
