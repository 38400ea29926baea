// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/merge.hpp"
#include "core/overlay.hpp"
#include "core/tin.hpp"

namespace terrane::soak {

/// One overlay of two TINs or one merge of tiles, all of it drawn from the seed: the same on every machine.
struct Case {
  std::string kind;
  std::vector<Tin> inputs;  // valid; two for an overlay
  bool merge = false;
  OverlayOptions options;
  MergeOptions merging;
  int threads = 1;
};

Case make_case(std::uint64_t seed);

}  // namespace terrane::soak
