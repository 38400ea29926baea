// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/tokens.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>

#include "core/error.hpp"
#include "ops/sha256.hpp"
#include "server/http/header_fields.hpp"
#include "server/http/message.hpp"

namespace terrane {

namespace {

/// "token68" of RFC 9110: what may stand behind "Bearer ".
bool is_token(std::string_view text) {
  const std::size_t end = text.find_last_not_of('=');
  if (end == std::string_view::npos) return false;
  return std::all_of(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end) + 1, [](unsigned char c) {
    return std::isalnum(c) || (c != 0 && std::string_view("-._~+/").find(static_cast<char>(c)) != std::string::npos);
  });
}

/// Of two hashes, which have one length. Looks at every byte whatever it has seen: how long it takes tells nothing.
bool are_equal(std::string_view a, std::string_view b) {
  volatile unsigned char difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference = difference | static_cast<unsigned char>(a[i] ^ b[i]);
  return difference == 0;
}

}  // namespace

Tokens::Tokens(std::string_view text) {
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string token, name, word;
    words >> token;
    while (words >> word) name += (name.empty() ? "" : " ") + word;
    if (token.empty()) continue;
    const std::string place = "line " + std::to_string(number);
    if (!is_token(token)) {
      throw Error(ErrorKind::usage, "bad-token",
                  "The token in " + place + " of the token file has characters other than letters, digits and -._~+/.");
    }
    std::string hash = sha256(token);
    const auto same = [&](const Entry& entry) { return entry.hash == hash; };
    if (std::any_of(entries_.begin(), entries_.end(), same)) {
      throw Error(ErrorKind::usage, "bad-token", "The token in " + place + " of the token file is there twice.");
    }
    entries_.push_back({std::move(hash), name.empty() ? place : header_text(name)});
  }
  if (entries_.empty()) throw Error(ErrorKind::usage, "no-token", "There is no token in the token file.");
}

Tokens Tokens::from_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  if (!file || !(text << file.rdbuf())) {
    throw Error(ErrorKind::usage, "bad-token-file", "The token file " + path + " cannot be read or is empty.");
  }
  return Tokens(text.str());
}

std::optional<std::string> Tokens::owner(std::string_view authorization) const {
  constexpr std::string_view scheme = "bearer ";
  authorization = trimmed_field(authorization);
  if (small_letters(authorization.substr(0, scheme.size())) != scheme) return std::nullopt;
  const std::string hash = sha256(trimmed_field(authorization.substr(scheme.size())));
  const Entry* found = nullptr;
  for (const Entry& entry : entries_)
    if (are_equal(entry.hash, hash)) found = &entry;
  return found ? std::optional(found->name) : std::nullopt;
}

std::string check_token(const Tokens& tokens, std::string_view authorization) {
  if (auto owner = tokens.owner(authorization)) return *std::move(owner);
  if (trimmed_field(authorization).empty()) {
    throw HttpError(401, "token-needed", "Send a token of this service as Authorization: Bearer TOKEN.",
                    {{"WWW-Authenticate", "Bearer realm=\"terrane\""}});
  }
  throw HttpError(401, "unknown-token", "The Authorization header has no token of this service.",
                  {{"WWW-Authenticate", "Bearer realm=\"terrane\", error=\"invalid_token\""}});
}

}  // namespace terrane
