// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/message.hpp"

// The grammar that headers share: lists, parameters, weights, entity tags.
namespace terrane {

/// Without the spaces and tabs at both ends.
std::string_view trimmed_field(std::string_view text);
/// ASCII letters made small.
std::string small_letters(std::string_view text);
/// The trimmed elements between separators that stand outside quotes; empty ones are kept.
std::vector<std::string_view> split_field(std::string_view text, char separator);

/// An element of a list with weights, such as "gzip;q=0.5".
struct Weighted {
  std::string value;  // in small letters, without parameters
  double weight = 1;  // 0 when it is no number
};
/// The elements that are not empty, in the order given.
std::vector<Weighted> weighted_list(std::string_view text);

/// The value of a header of an answer, whatever the case of its name; nothing when it is not there.
std::optional<std::string> reply_header(const Reply& reply, std::string_view name);
/// Puts the value in the place of all there are of that name.
void set_reply_header(Reply& reply, std::string_view name, std::string value);
void remove_reply_header(Reply& reply, std::string_view name);
/// Adds a name to Vary unless it is there.
void vary_on(Reply& reply, std::string_view name);

}  // namespace terrane
