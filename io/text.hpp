// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstdlib>
#include <string>
#include <string_view>

#include "core/tin.hpp"

// Numbers and blanks of text formats. Numbers are exact on the round trip: shortest to_chars out, from_chars in.
namespace terrane {

inline constexpr std::size_t number_size = 24;  // no double and no integer takes more characters

/// Puts a number where number_size characters fit; where it ends.
inline char* put_number(char* to, double value) { return std::to_chars(to, to + number_size, value).ptr; }
inline char* put_number(char* to, std::integral auto value) { return std::to_chars(to, to + number_size, value).ptr; }

inline char* put_text(char* to, std::string_view text) { return std::copy(text.begin(), text.end(), to); }

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
inline bool is_space(char c) { return is_blank(c) || c == '\n' || c == '\v' || c == '\f'; }

inline const char* skip_blanks(const char* p, const char* end) {
  while (p != end && is_blank(*p)) ++p;
  return p;
}

inline const char* skip_spaces(const char* p, const char* end) {
  while (p != end && is_space(*p)) ++p;
  return p;
}

inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

/// Without the byte order mark that some editors put before UTF-8.
inline std::string_view without_mark(std::string_view text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

inline std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

/// Parses a finite number at p; nullptr when there is none (words, NaN, infinity, 1e400).
inline const char* parse_number(const char* p, const char* end, double& value) {
  if (p != end && *p == '+') {
    ++p;
    if (p != end && *p == '-') return nullptr;
  }
  const auto [next, error] = std::from_chars(p, end, value);
  if (error == std::errc::result_out_of_range) {
    // from_chars says the same of 1e400 and of 1e-400; the latter is a number.
    value = std::strtod(std::string(p, next).c_str(), nullptr);
    return std::isfinite(value) ? next : nullptr;
  }
  return error == std::errc() && std::isfinite(value) ? next : nullptr;
}

/// Parses a vertex index, decimal digits alone, of at most `most`; nullptr when there is none.
inline const char* parse_index(const char* p, const char* end, Index most, Index& value) {
  const char* const first = p;
  std::int64_t sum = 0;
  for (; p != end && static_cast<unsigned char>(*p - '0') < 10; ++p) {
    sum = sum * 10 + (*p - '0');
    if (sum > most) return nullptr;
  }
  value = static_cast<Index>(sum);
  return p == first ? nullptr : p;
}

/// Text for one line of a comment: whatever would end it becomes a blank.
inline std::string one_line(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return out;
}

}  // namespace terrane
