// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace terrane {

/// True when the first directory of a TIFF (classic or Big, either byte order) and the values of all its tags lie
/// within the bytes. A library reads on without a tag that is cut off: the CRS or the NoData value would be gone in
/// silence.
bool tiff_directory_complete(std::string_view bytes);

}  // namespace terrane
