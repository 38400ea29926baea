// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ops/operation.hpp"

// Tables of heights, a column per surface.
namespace terrane {

/// The surfaces of an input that takes several, in their order.
std::vector<const Surface*> surfaces_of(const std::vector<Surface>& inputs, std::string_view slot);

/// "z" for one surface; for several "z_" and their file names without what follows the last dot, numbered where these
/// are not all different.
std::vector<std::string> height_columns(const std::vector<const Surface*>& surfaces);

/// A cell of a CSV table, in quotes where it must be.
std::string csv_cell(std::string_view text);
/// A number as short as it can be read back exactly; nothing for NaN.
void add_number(std::string& csv, double value);

}  // namespace terrane
