// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/context.hpp"
#include "core/tin.hpp"

namespace terrane {

/// The TIN through the border of a surface alone, holes included: what a stockpile stands on when nothing else was
/// surveyed. Same domain as the surface; its vertices are those of the border, at the foot where the border is a wall;
/// constrained Delaunay in plan. Precondition: a valid TIN. O(n + b log b) for b border edges.
Tin toe_surface(const Tin& tin, const Context& context);

}  // namespace terrane
