// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "core/surface.hpp"

namespace terrane {

/// The TIN of a corner surface whose faces agree about every height, as those of most overlays do: nothing to weld, cut
/// or wall. None where some place has two heights. Vertices are the surface's points, those no face uses among them.
/// O(n).
std::optional<Tin> single_valued(const CornerSurface& surface);

}  // namespace terrane
