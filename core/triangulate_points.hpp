// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/context.hpp"
#include "core/shapes.hpp"
#include "core/tin.hpp"

namespace terrane {

struct SurveyOptions {
  bool average = false;  // heights that differ at one place are replaced by their mean; otherwise they are refused
  double max_edge = 0;   // 0: no limit
  /// Lengths for max_edge; null: in the plane.
  std::function<double(Point2, Point2)> length = nullptr;
};

struct Survey {
  Tin tin;
  std::size_t duplicates = 0;  // points that were at the place of another
  std::size_t averaged = 0;    // places whose heights differed
  std::size_t crossings = 0;   // places that breaklines were cut at
  std::size_t left_out = 0;    // points that no face reaches after max_edge
};

/// The Delaunay triangulation of points, every segment of a breakline an edge or a row of edges of it. Breaklines may
/// touch and cross, at one height; where they cross is a vertex, rounded to doubles. With `max_edge` faces with a
/// longer edge are taken away from the border inwards: what lies between far points of a hollow border is no survey. A
/// breakline's corner without a height (NaN) takes that of the point at its place. Throws Error{input}:
/// "different-heights" naming up to 20 places, "no-height", "too-few-points" when all lie on one line. Exact
/// predicates; the same for any order of points and lines. O(n log n). See Shewchuk (1996) on constraints.
Survey triangulate_points(std::vector<Point> points, const std::vector<Line>& breaklines, const SurveyOptions& options,
                          Context& context);

}  // namespace terrane
