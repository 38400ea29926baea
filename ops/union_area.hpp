// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/context.hpp"
#include "core/tin.hpp"

namespace terrane {

/// The area in plan of the union of the domains, in squared plan units, from the borders alone: what a merge's area
/// is held
/// against. Independent of the overlay: the border of the union is made of those pieces of the tiles' borders that
/// have no
/// other tile on their outer side, and Green's theorem gives its area. Good to about 1e-12 of the union's box.
/// O(n log n) for n faces, plus the crossings of the borders.
double union_area(const std::vector<const Tin*>& tiles, Context& context);

}  // namespace terrane
