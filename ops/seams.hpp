// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/merge.hpp"

namespace terrane {

/// The seam report of the contract; `names` by index of the tile.
nlohmann::json seam_report(const std::vector<SeamPair>& pairs, const std::vector<std::string>& names);

/// Fills the jumps of a pair from the jumps that are left in a result, for operations whose jumps are not those of a
/// merge.
void measure_jumps(const Tin& result, SeamPair& pair);

}  // namespace terrane
