// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

#include "core/tin.hpp"

namespace terrane {

/// A line of text as strokes of a pen: x to the right from the first letter, y up from the baseline, capitals 1 high.
struct Lettering {
  std::vector<std::vector<Point2>> strokes;
  double width = 0;
};

/// `text` is UTF-8. Letters, digits and punctuation of ASCII, and the signs for minus, degree, square and cube; a box
/// for anything else.
Lettering lettering(std::string_view text);

}  // namespace terrane
