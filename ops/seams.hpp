// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/merge.hpp"
#include "io/vectors.hpp"

namespace terrane {

/// The seam report of the contract; `names` by index of the tile.
nlohmann::json seam_report(const std::vector<SeamPair>& pairs, const std::vector<std::string>& names);

/// The jumps as lines: a, b, kind, jump_start and jump_end (b - a), max_abs, and length in the CRS's length unit.
Vectors seam_lines(const Merged& merged, const std::vector<std::string>& names, const Crs& crs);

/// Fills the jumps of a pair from the jumps that are left in a result, for operations whose jumps are not those of a
/// merge.
void measure_jumps(const Tin& result, const PlanMetric& metric, SeamPair& pair);

}  // namespace terrane
