// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace terrane {

/// RFC 4648, padding demanded, blanks and line ends left out. `what` names it in messages. Throws Error{usage}.
std::string decode_base64(std::string_view text, const std::string& what);
std::string encode_base64(std::string_view bytes);

}  // namespace terrane
