// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "core/context.hpp"
#include "ops/outcome.hpp"

namespace terrane {

/// The area in plan of the union of the domains, in squared plan units, from the borders alone: what a merge's area
/// is held against. Independent of the overlay: the border of the union is made of those pieces of the tiles' borders
/// that have no other tile on their outer side, and Green's theorem gives its area; where borders run beside each other
/// so near that rounding decides the side, the union is measured slab by slab instead. Good to about 1e-12 of the
/// union's box. None, with a warning, where that would take too long.
/// O(n log n) for n faces, plus the crossings of the borders; by slabs, border edges times slabs they span.
std::optional<double> union_area(const HeightFields& tiles, Context& context);

}  // namespace terrane
