// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "soak/cases.hpp"

namespace terrane::soak {

struct Verdict {
  std::string wrong;     // empty: every promise is kept
  std::string refused;   // the reason given, when there is no result
  bool counted = false;  // the regions were compared with the exact arrangement
};

/// Computes a case and judges the result. `seed` decides which of the slow checks are made.
Verdict judge(const Case& made, std::uint64_t seed);

}  // namespace terrane::soak
