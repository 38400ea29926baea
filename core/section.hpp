// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/context.hpp"
#include "core/face_grid.hpp"
#include "core/tin.hpp"

namespace terrane {

/// Heights of several surfaces along a line, as a table: one row per station, one height per surface. Stations are the
/// line's corners and every place where it crosses an edge of any of the surfaces. Between two rows every surface is
/// linear, or there is none: then its height is NaN in both. Where a surface begins, ends or jumps there are two rows
/// at one place, what lies before it and what lies behind.
struct Section {
  struct Row {
    std::size_t segment;  // of the line, from 0
    double along;         // 0 at its first end, 1 at its second
    Point2 at;
  };
  std::size_t surfaces = 0;
  std::vector<Row> rows;
  std::vector<double> z;  // rows * surfaces

  double height(std::size_t row, std::size_t surface) const { return z[row * surfaces + surface]; }
};

/// The section of surfaces along a line of two or more places, all different from their neighbours. Which edges are
/// crossed is decided exactly; heights are those of the edges there, to rounding. Jumps up to 1e-9 * max(1, |z|) are
/// rounding and have one row. Along an edge with a jump, the line runs on the upper side; a surface that it touches in
/// a single place is not there. O(faces near the line) and sorting what is crossed.
Section section(std::span<const Point2> line, std::span<const FaceGrid* const> surfaces, Context& context);

}  // namespace terrane
