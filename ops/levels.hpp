// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace terrane {

/// Levels as the parameter `levels` takes them: a list (90,95,100) or from:to:step (90:110:5). Throws Error{usage}.
std::vector<double> parse_levels(const std::string& text);

}  // namespace terrane
