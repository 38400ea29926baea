// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/shade.hpp"

namespace terrane {

/// What is written beside a map.
struct SheetOptions {
  std::string title;                             // over the colour bar: "Height (m)"
  double low = 0, high = 1;                      // of the colour bar
  bool beyond_low = false, beyond_high = false;  // heights go on past its ends, which then are pointed
  bool signs = false;                            // + in front of what is above 0
  double ground_per_unit = 0;    // what a plan unit is long on the ground in x, in `ground_unit`; 0: no scale bar
  std::string ground_unit = {};  // "m", "ft", "ftUS", or nothing
};

/// The surface with a colour bar to its right and a scale bar below, neither over the map. The longer side of the whole
/// has `options.size` pixels; around the map it is transparent, letters have a white rim. Pictures of less than 200
/// pixels, for which there is no room beside the map, are the map alone. `options.colours` must be there.
Picture map_sheet(const Tin& tin, const ShadeOptions& options, const SheetOptions& sheet, Context& context);

}  // namespace terrane
