// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/ticks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace terrane {

double round_down(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double digit : {5.0, 2.0})
    if (digit * power <= value * (1 + 1e-12)) return digit * power;
  return power;
}

Ticks ticks(double low, double high, double count) {
  Ticks out;
  const double range = high - low;
  if (!(range > 0) || !std::isfinite(range)) {
    out.at = {low};
    out.step = std::fabs(low) > 0 ? std::pow(10, std::floor(std::log10(std::fabs(low))) - 3) : 1;
    out.decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(out.step) - 1e-9)), 0, 12);
    return out;
  }
  // The round step whose number of ticks is nearest, by ratio.
  const double ideal = range / std::max(count, 1.0), below = round_down(ideal);
  const double lead = below / std::pow(10, std::floor(std::log10(below) + 1e-9));
  const double above = below * (lead > 1.5 && lead < 3 ? 2.5 : 2);
  out.step = ideal / below < above / ideal ? below : above;
  out.decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(out.step) - 1e-9)), 0, 12);
  const double slack = 1e-9;
  const double first = std::ceil(low / out.step - slack), last = std::floor(high / out.step + slack);
  for (double k = first; k <= last && out.at.size() < 1000; ++k) out.at.push_back(k * out.step + 0.0);
  return out;
}

std::string Ticks::label(double value, bool plus) const {
  char text[64];
  if (std::fabs(value) >= 1e15)
    std::snprintf(text, sizeof text, "%.6g", value);
  else
    std::snprintf(text, sizeof text, "%.*f", decimals, std::fabs(value) < step * 1e-6 ? 0.0 : value);
  std::string label = text;
  if (label.starts_with('-'))
    label = "\xE2\x88\x92" + label.substr(1);
  else if (plus && value > 0)
    label = "+" + label;
  return label;
}

}  // namespace terrane
