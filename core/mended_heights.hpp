// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "core/array.hpp"
#include "core/tin.hpp"

namespace terrane {

/// The heights of a surface at the corners of a face, and how far they may be off.
struct OwnHeights {
  double z[3];
  double error;
};

/// Gives the faces that mending changed, all of them on the surface, the heights at their corners. `z`: per vertex; NaN
/// where mending brought a vertex of the outside into the domain, which takes the height of the face. A sliver thinner
/// than rounding may be a cliff, and mending it away lets faces of its two sides meet at one vertex: then the faces on
/// the other side keep their own height there, z becomes one per corner (3 * face + corner), and the result is true.
bool mend_heights(const Array<Face>& faces, const std::vector<Index>& changed,
                  const std::function<OwnHeights(Index face)>& own_heights, Array<double>& z);

/// By how much a height on a triangle may differ from that of a triangle beside it because their vertices were rounded
/// by `max_move`. That one may be many times as steep, and lie beyond others.
double height_error(const Point2 (&corners)[3], const double (&z)[3], double max_move);

}  // namespace terrane
