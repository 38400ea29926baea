// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/requests/json_slices.hpp"

#include <bitset>
#include <set>

#include "core/error.hpp"

namespace terrane {

namespace {

class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::usage, "invalid-json", what + " at byte " + std::to_string(at_) + " of the JSON body.");
  }

  void skip_space() {
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos) ++at_;
  }

  char peek() {
    skip_space();
    return at_ < text_.size() ? text_[at_] : '\0';
  }

  bool take(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }

  void expect(char c) {
    if (!take(c)) fail(std::string("'") + c + "' is missing");
  }

  void expect_end() {
    if (peek() != '\0' || at_ != text_.size()) fail("There is text behind the value");
  }

  std::string_view string() {
    const std::size_t begin = at_;
    expect('"');
    for (; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\\') ++at_;
    }
    if (at_ >= text_.size()) fail("A string does not end");
    ++at_;
    return text_.substr(begin, at_ - begin);
  }

  std::string_view value() {
    const char first = peek();
    const std::size_t begin = at_;
    if (first == '"') return string();
    if (first == '{' || first == '[') {
      skip_brackets();
    } else {
      while (at_ < text_.size() && std::string_view(",]} \t\r\n").find(text_[at_]) == std::string_view::npos) ++at_;
    }
    if (at_ == begin) fail("A value is missing");
    return text_.substr(begin, at_ - begin);
  }

 private:
  /// From an opening bracket to behind the one that closes it.
  void skip_brackets() {
    std::bitset<max_json_depth> is_object;
    int depth = 0;
    do {
      if (at_ >= text_.size()) fail("A bracket is not closed");
      const char c = text_[at_];
      if (c == '"') {
        string();
        continue;
      }
      ++at_;
      if (c == '{' || c == '[') {
        if (depth == max_json_depth) fail("Values are nested deeper than 64");
        is_object[depth++] = c == '{';
      } else if (c == '}' || c == ']') {
        if (is_object[--depth] != (c == '}')) fail("A bracket closes another kind");
      }
    } while (depth > 0);
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

void check_count(std::size_t count) {
  if (count == max_json_members) {
    throw Error(ErrorKind::limit, "too-many-values", "More than 4096 values in one object or array of the request.");
  }
}

}  // namespace

JsonMembers json_members(std::string_view text) {
  Scanner scanner(text);
  JsonMembers members;
  std::set<std::string> names;
  scanner.expect('{');
  if (!scanner.take('}')) {
    do {
      check_count(members.size());
      scanner.skip_space();
      std::string name = parse_json(scanner.string(), "a name").get<std::string>();
      scanner.expect(':');
      if (!names.insert(name).second) scanner.fail("A second value of the same name ends");
      members.emplace_back(std::move(name), scanner.value());
    } while (scanner.take(','));
    scanner.expect('}');
  }
  scanner.expect_end();
  return members;
}

std::vector<std::string_view> json_elements(std::string_view text) {
  Scanner scanner(text);
  std::vector<std::string_view> elements;
  scanner.expect('[');
  if (!scanner.take(']')) {
    do {
      check_count(elements.size());
      elements.push_back(scanner.value());
    } while (scanner.take(','));
    scanner.expect(']');
  }
  scanner.expect_end();
  return elements;
}

char json_kind(std::string_view text) { return Scanner(text).peek(); }

nlohmann::json parse_json(std::string_view text, const std::string& what) {
  try {
    return nlohmann::json::parse(text, [&](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
      if (depth > max_json_depth) {
        throw Error(ErrorKind::usage, "invalid-json", "Values in " + what + " are nested deeper than 64.");
      }
      return true;
    });
  } catch (const nlohmann::json::exception&) {
    throw Error(ErrorKind::usage, "invalid-json",
                "The JSON of " + what + " is not valid: check its quotes, commas and numbers.");
  }
}

}  // namespace terrane
