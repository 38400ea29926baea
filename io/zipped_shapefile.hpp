// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace terrane {

/// GDAL's names of the shapefiles in a zip file, in whatever folders they lie, in the order of their paths. `file` is
/// GDAL's name of the bytes, `name` is for messages. What the zip holds is bounded before any of it is unpacked.
std::vector<std::string> shapefiles_in(std::string_view bytes, const std::string& file, const std::string& name);

/// Refuses a definition of a CRS that names grid files: GDAL opens them as soon as it reads it.
void refuse_grid_files(std::string_view definition, const std::string& name);

}  // namespace terrane
