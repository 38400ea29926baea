// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/levels.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/error.hpp"
#include "ops/parameters.hpp"

namespace terrane {

std::vector<double> parse_levels(const std::string& text) {
  const auto wrong = [&](const char* why) -> Error {
    return {ErrorKind::usage, "bad-parameter", "parameter 'levels' is '" + text.substr(0, 80) + "'; " + why};
  };
  const auto split = [&](char mark) {
    std::vector<double> values;
    std::size_t begin = 0;
    while (begin <= text.size()) {
      const std::size_t end = std::min(text.find(mark, begin), text.size());
      const auto value = parse_number(std::string_view(text).substr(begin, end - begin));
      if (!value) throw wrong("it takes numbers separated by commas, or from:to:step");
      values.push_back(*value);
      begin = end + 1;
    }
    return values;
  };
  if (text.find(':') == std::string::npos) return split(',');
  const auto range = split(':');
  if (range.size() != 3 || range[2] <= 0 || range[1] < range[0]) throw wrong("a range is from:to:step, upwards");
  const double steps = std::floor((range[1] - range[0]) / range[2] * (1 + 1e-12));
  if (steps > 10000) throw wrong("that is more than 10000 levels");
  std::vector<double> levels;
  for (int i = 0; i <= steps; ++i) levels.push_back(range[0] + i * range[2]);
  return levels;
}

}  // namespace terrane
