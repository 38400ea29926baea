// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ops/operation.hpp"
#include "ops/outcome.hpp"
#include "ops/parameters.hpp"

namespace terrane {

/// The step in the coordinates of a CRS that the parameter `grid` asks for; 0: none. Where coordinates are degrees, the
/// largest of 1, 2 or 5 times a power of ten that is nowhere longer on the ground.
double grid_step(const Length& asked, const Crs& crs);

/// Does the plan ask for a grid?
bool wants_grid(const Plan& plan, const Crs& crs);

/// Rounds a surface to the plan's grid, where it asks for one; the rounding report and the part "grid" of the
/// certificate say what that did. Returns whether it did. Throws Error{input, "grid"}.
bool put_on_grid(Outcome& outcome, const Plan& plan, const Crs& crs, Context& context);

}  // namespace terrane
