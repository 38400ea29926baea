// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/tin.hpp"

// Lines and polygons as values, as they come from vector files and go to them.
namespace terrane {

/// A polyline; z is NaN where there is none.
using Line = std::vector<Point>;

/// A polygon with holes: rings closed without repeating their first corner, of either orientation, and not promised to
/// be simple.
struct Polygon {
  Line outer;
  std::vector<Line> holes;
};

/// Points that are to become a surface.
struct PointCloud {
  std::vector<Point> points;
};

}  // namespace terrane
