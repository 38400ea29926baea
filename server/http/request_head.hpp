// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/http/message.hpp"

// The request line and the header lines, vetted before anything else looks at them (RFC 9112, strictly).
namespace terrane {

/// How the end of a body is found.
enum class Framing { none, length, chunks };

struct RequestHead {
  std::string method, target, version;  // "HTTP/1.1"
  TextPairs headers;                    // names in small letters, in the order of the names; values as sent
  Framing framing = Framing::none;
  std::uint64_t length = 0;  // of a body of Framing::length; of 19 digits and more: the largest number there is
  bool expects_continue = false;
  bool says_nothing_of_body = false;  // POST, PUT or PATCH without a length: what follows may be a body all the same

  /// The value of the first header of that name, or "".
  std::string_view value(std::string_view small_name) const;
  std::size_t count(std::string_view small_name) const;
};

/// Bytes of the head at the beginning of `input`, its empty line included; 0 when it is not complete yet. Empty lines
/// before a request are part of it. Throws HttpError 414 or 431 as soon as it is longer than it may be.
std::size_t head_size(std::string_view input);

/// A complete head. Throws HttpError: 400 for anything but CRLF lines of names and values, a length that is said twice
/// or is no number, an unknown transfer coding; 431 for too many lines, 416 for too many ranges.
RequestHead parse_head(std::string_view head);

/// The head for the library: only what it has to know, and the length the body has in the end. It unpacks %41 in values
/// and passes over lines it does not understand, so what it would see of the original may be another request.
std::string head_for_library(const RequestHead& head, std::uint64_t body_size);

}  // namespace terrane
