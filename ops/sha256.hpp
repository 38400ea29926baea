// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace terrane {

/// SHA-256 (FIPS 180-4) of bytes, in lower-case hexadecimal: how a certificate names its inputs.
std::string sha256(std::string_view bytes);

}  // namespace terrane
