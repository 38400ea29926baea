// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "core/merge.hpp"

namespace terrane::support {

/// What is wrong with a TIN with walls, in plan and as one oriented surface: see wrong_in_plan and open_seams; walls
/// that are not vertical edges' own, vertices twice in all three coordinates. `split`: open jumps are right.
std::string wrong_with_surface(const Tin& tin, bool split);

/// Which promises of core/merge.hpp a merge breaks, judged without code of the core: a valid surface; the area of the
/// union but for what rounding moves; at every vertex a height that the policy makes of the tiles' heights within reach
/// of rounding; vertices of the tiles present but for those snapped or covered. For small tiles.
std::string broken_promises(const std::vector<Tin>& tiles, const MergeOptions& options, const Merged& merged);

/// The area in plan of the union of the domains, by horizontal slabs in long doubles: its error is about 1e-18 of the
/// box times the edges of the borders.
double union_area(const std::vector<Tin>& tiles);

}  // namespace terrane::support
