// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/picture/picture.hpp"
#include "core/section.hpp"

namespace terrane {

/// A section to be drawn.
struct ChartPanel {
  const Section* section;
  std::vector<double> distance;  // of each row along the line, ascending from 0
  std::string title;             // in its upper left corner; may be empty
};

struct ChartOptions {
  int size = 1200;                                 // pixels across
  std::vector<std::string> names;                  // of the surfaces
  std::string length_unit = {}, height_unit = {};  // "m", "ft", "ftUS", or nothing
  double heights_per_length = 1;  // height units in a length unit, for the exaggeration; 0: not to be said
};

/// Heights over distance, a panel below the other, all in the same colours: axes with round numbers, a line per
/// surface, vertical where it jumps and interrupted where there is none, what each colour means above. On white.
Picture profile_chart(std::span<const ChartPanel> panels, const ChartOptions& options);

}  // namespace terrane
