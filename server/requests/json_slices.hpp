// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// JSON cut into pieces without building a tree: a surface of a gigabyte inside a request stays the bytes it came as.
// The pieces of inputs are checked by the readers of their format, which name the vertex or face that is wrong.
namespace terrane {

inline constexpr int max_json_depth = 64;
inline constexpr std::size_t max_json_members = 4096;

using JsonMembers = std::vector<std::pair<std::string, std::string_view>>;

/// The members of an object, in order, each value as its text. Throws Error{usage} "invalid-json" when the text is no
/// object, when a name comes twice, when brackets do not match or are nested deeper than 64, and Error{limit} for more
/// than 4096 members. What stands between the brackets of a member's value is not looked at. O(text).
JsonMembers json_members(std::string_view text);
/// The same for an array.
std::vector<std::string_view> json_elements(std::string_view text);

/// The first character of the value: '{', '[', '"', or that of a number or word; 0 when there is none.
char json_kind(std::string_view text);

/// A value as a tree, no deeper than 64. `what` names it in messages. Throws Error{usage} "invalid-json".
nlohmann::json parse_json(std::string_view text, const std::string& what);

}  // namespace terrane
