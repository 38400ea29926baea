// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/header_fields.hpp"

#include <algorithm>
#include <charconv>

namespace terrane {

namespace {

double weight_of(std::string_view text) {
  double weight = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), weight);
  return error == std::errc() && end == text.data() + text.size() && weight >= 0 ? std::min(weight, 1.0) : 0;
}

bool same_name(std::string_view a, std::string_view b) { return small_letters(a) == small_letters(b); }

}  // namespace

std::string_view trimmed_field(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string small_letters(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

std::vector<std::string_view> split_field(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  std::size_t begin = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') quoted = !quoted;
    if (quoted || text[i] != separator) continue;
    parts.push_back(trimmed_field(text.substr(begin, i - begin)));
    begin = i + 1;
  }
  parts.push_back(trimmed_field(text.substr(begin)));
  return parts;
}

std::vector<Weighted> weighted_list(std::string_view text) {
  std::vector<Weighted> list;
  for (const std::string_view element : split_field(text, ',')) {
    if (element.empty()) continue;
    const auto parts = split_field(element, ';');
    Weighted weighted;
    weighted.value = small_letters(parts[0]);
    for (std::size_t i = 1; i < parts.size(); ++i) {
      const std::string parameter = small_letters(parts[i]);
      if (parameter.starts_with("q=")) weighted.weight = weight_of(std::string_view(parameter).substr(2));
    }
    list.push_back(std::move(weighted));
  }
  return list;
}

std::optional<std::string> reply_header(const Reply& reply, std::string_view name) {
  for (const auto& [key, value] : reply.headers)
    if (same_name(key, name)) return value;
  return std::nullopt;
}

void remove_reply_header(Reply& reply, std::string_view name) {
  std::erase_if(reply.headers, [&](const auto& header) { return same_name(header.first, name); });
}

void set_reply_header(Reply& reply, std::string_view name, std::string value) {
  remove_reply_header(reply, name);
  reply.headers.emplace_back(name, std::move(value));
}

void vary_on(Reply& reply, std::string_view name) {
  std::string all;
  for (const auto& [key, value] : reply.headers) {
    if (!same_name(key, "Vary")) continue;
    for (const std::string_view element : split_field(value, ',')) {
      if (element == "*" || same_name(element, name)) return;
    }
    all += (all.empty() ? "" : ", ") + value;
  }
  set_reply_header(reply, "Vary", all.empty() ? std::string(name) : all + ", " + std::string(name));
}

}  // namespace terrane
