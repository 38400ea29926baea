// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace terrane {

/// Text as a JSON value, no deeper than 64, that a schema allows. Of JSON Schema it knows type, enum, minimum, maximum,
/// required, properties, items, minItems, maxItems and oneOf (where it is content with one that fits). Throws
/// Error{usage} "bad-parameter" saying which part of `what` is wrong.
nlohmann::json parse_json_value(std::string_view text, const nlohmann::json& schema, const std::string& what);

/// JSON as text, whatever strings it holds: what is not UTF-8, as in file names of old programs, becomes U+FFFD.
std::string json_text(const nlohmann::json& value, int indent = -1);
/// The same for one string.
std::string utf8_text(const std::string& text);

}  // namespace terrane
