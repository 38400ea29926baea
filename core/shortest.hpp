// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <charconv>
#include <cmath>
#include <string>

namespace terrane {

/// The shortest text that reads back as the number, for messages; without an exponent where people write none.
inline std::string shortest(double x) {
  char text[32];
  const bool plain = x == 0 || (std::fabs(x) >= 1e-5 && std::fabs(x) < 1e15);
  const auto end = plain ? std::to_chars(text, text + sizeof text, x, std::chars_format::fixed)
                         : std::to_chars(text, text + sizeof text, x);
  return {text, end.ptr};
}

}  // namespace terrane
