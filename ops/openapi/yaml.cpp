// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/openapi/yaml.hpp"

#include <algorithm>
#include <cctype>

namespace terrane {
namespace {

bool plain(const std::string& text) {
  if (text.empty() || !std::isalpha(static_cast<unsigned char>(text[0]))) return false;
  for (const char* word : {"true", "false", "null", "yes", "no", "on", "off", "y", "n"}) {
    const std::string w = word;
    if (std::equal(text.begin(), text.end(), w.begin(), w.end(),
                   [](unsigned char a, char b) { return std::tolower(a) == b; }))
      return false;
  }
  return std::all_of(text.begin(), text.end(),
                     [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_' || c == '.'; });
}

std::string scalar(const nlohmann::json& value) {
  if (value.is_string() && plain(value)) return value;
  return value.dump();  // JSON's quoted strings are YAML's
}

void write(const nlohmann::json& value, int indent, std::string& out) {
  const std::string pad(indent, ' ');
  const auto nested = [&](const nlohmann::json& child) {
    return (child.is_object() || child.is_array()) && !child.empty();
  };
  if (value.is_object()) {
    for (const auto& [key, child] : value.items()) {
      out += pad + (plain(key) ? key : nlohmann::json(key).dump()) + ":";
      if (nested(child)) {
        out += "\n";
        write(child, indent + 2, out);
      } else {
        out += " " + scalar(child) + "\n";
      }
    }
  } else if (value.is_array()) {
    for (const auto& child : value) {
      if (!nested(child)) {
        out += pad + "- " + scalar(child) + "\n";
        continue;
      }
      std::string block;
      write(child, indent + 2, block);
      block.replace(indent, 2, "- ");
      out += block;
    }
  } else {
    out += pad + scalar(value) + "\n";
  }
}

}  // namespace

std::string yaml(const nlohmann::json& value) {
  std::string out;
  write(value, 0, out);
  return out;
}

}  // namespace terrane
