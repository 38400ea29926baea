// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace terrane {

bool is_utf8(std::string_view text);

/// Text from a file, in UTF-8 as every document of ours is: what is none is taken for Latin-1, which old programs write.
std::string in_utf8(std::string_view text);

}  // namespace terrane
