// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Bearer tokens: RFC 6750.
namespace terrane {

class Tokens {
 public:
  /// Nobody needs a token.
  Tokens() = default;
  /// One token per line and, after a space, the name of whom it was given to; "#" begins a comment. Throws Error{usage}
  /// naming the line, never the token, when one is malformed or given twice, and when there is none at all.
  explicit Tokens(std::string_view text);
  static Tokens from_file(const std::string& path);

  bool are_needed() const { return !entries_.empty(); }
  /// The name of the token's owner, "line 3" where it has none, for the value of an Authorization header; nothing when
  /// there is no such token. Takes as long for a token that is nearly right as for any other.
  std::optional<std::string> owner(std::string_view authorization) const;

 private:
  struct Entry {
    std::string hash, name;
  };
  std::vector<Entry> entries_;  // the tokens themselves are not kept
};

/// Throws HttpError 401 with WWW-Authenticate unless the header has one of the tokens; returns the owner's name.
std::string check_token(const Tokens& tokens, std::string_view authorization);

}  // namespace terrane
