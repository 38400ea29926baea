// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

namespace terrane {

/// 8-bit RGBA, row by row from the top; alpha 0 where there is nothing.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

struct Colour {
  double r = 0, g = 0, b = 0;  // 0 to 1
};

inline Colour operator*(double s, Colour c) { return {s * c.r, s * c.g, s * c.b}; }
inline Colour operator+(Colour a, Colour b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }

}  // namespace terrane
