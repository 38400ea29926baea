// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/context.hpp"
#include "core/shapes.hpp"
#include "core/tin.hpp"

// Isolines of a TIN, joined into long lines.
namespace terrane {

struct Contour {
  double level;
  Line line;  // z is the level everywhere; closed: the first point is repeated at the end
  bool closed;
};

/// The contours of a surface at `levels` (ascending, each once). That of level L is the border of the area {z >= L}, as
/// far as it lies inside the domain: so the border of the domain is none, a flat area at exactly L has its own border
/// for one, a ridge or a peak that only touches L none. The higher ground is on the right. Where the surface jumps
/// across L, a wall gives its line in plan, once; an open jump ends the contour. Points are vertices at the level, or
/// lie on edges, rounded to a double each; all faces at a place agree on it to the last bit.
/// Lines are as long as can be and never cross; where several meet in a point each keeps to one area of higher ground.
/// Ordered by level, lines with ends before closed ones, each from its first face in the TIN's order.
/// Precondition: a valid TIN (core/validate). The same bytes for any number of threads. O(n log m) for m levels, and
/// about 100 ns per face and level that it is crossed by. Throws Error{limit} beyond `most_crossings` of these.
std::vector<Contour> contours(const Tin& tin, std::span<const double> levels, Context& context);

inline constexpr std::size_t most_crossings = 100'000'000;

}  // namespace terrane
