// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <initializer_list>
#include <limits>
#include <string_view>

#include "core/raster.hpp"

namespace terrane::testing {

/// A raster one can see: the first line is the northernmost row, digits are heights, '.' is void. Cells are 1 x 1 and
/// the south-western sample lies at (0, 0), so that places are exact.
inline Raster ascii_raster(std::initializer_list<std::string_view> rows, double z_scale = 1) {
  Raster r;
  r.width = static_cast<int>(rows.begin()->size());
  r.height = static_cast<int>(rows.size());
  r.y0 = r.height - 1;
  r.dx = r.dy = 1;
  for (const std::string_view row : rows) {
    for (const char c : row) {
      r.samples.push_back(c == '.' ? std::numeric_limits<double>::quiet_NaN() : z_scale * (c - '0'));
    }
  }
  return r;
}

}  // namespace terrane::testing
