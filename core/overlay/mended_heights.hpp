// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "core/mesh/array.hpp"
#include "core/tin.hpp"

namespace terrane {

/// How far heights on a triangle may be off from those beside it, and between which ones they lie: a cliff an ulp wide
/// may have any of its own at a vertex that was rounded, but none above or below them.
struct HeightError {
  double error, low, high;
  bool covers(double own, double other) const {
    return std::fabs(own - other) <= error && low <= other && other <= high;
  }
};

/// The heights of a surface at the corners of a face.
struct OwnHeights {
  double z[3];
  HeightError error;
};

/// Gives the faces that mending changed, all of them on the surface, the heights at their corners. `z`: per vertex; NaN
/// where mending brought a vertex of the outside into the domain, which takes the height of the face. A sliver thinner
/// than rounding may be a cliff, and mending it away lets faces of its two sides meet at one vertex: then the faces on
/// the other side keep their own height there, z becomes one per corner (3 * face + corner), and the result is true.
bool mend_heights(const Array<Face>& faces, const std::vector<Index>& changed,
                  const std::function<OwnHeights(Index face)>& own_heights, Array<double>& z);

/// By how much a height on a triangle may differ from that of a triangle beside it because their vertices were rounded
/// by `max_move`. That one may be many times as steep, and lie beyond others.
HeightError height_error(const Point2 (&corners)[3], const double (&z)[3], double max_move);

}  // namespace terrane
