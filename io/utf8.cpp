// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/utf8.hpp"

#include <nlohmann/json.hpp>

namespace terrane {

bool is_utf8(std::string_view text) {
  try {
    nlohmann::json(text).dump();  // what writes our documents judges
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

std::string in_utf8(std::string_view text) {
  if (is_utf8(text)) return std::string(text);
  std::string out;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code >= 0x80) out += static_cast<char>(0xC0 | code >> 6);
    out += static_cast<char>(code >= 0x80 ? 0x80 | (code & 0x3F) : code);
  }
  return out;
}

}  // namespace terrane
