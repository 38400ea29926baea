// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/columns.hpp"

#include <charconv>
#include <cmath>
#include <set>

namespace terrane {

std::vector<const Surface*> surfaces_of(const std::vector<Surface>& inputs, std::string_view slot) {
  std::vector<const Surface*> found;
  for (const Surface& s : inputs)
    if (s.slot == slot) found.push_back(&s);
  return found;
}

std::vector<std::string> height_columns(const std::vector<const Surface*>& surfaces) {
  if (surfaces.size() == 1) return {"z"};
  std::vector<std::string> names;
  std::set<std::string> different;
  for (const Surface* s : surfaces) {
    const std::size_t dot = s->name.rfind('.');
    names.push_back("z_" + (dot == std::string::npos || dot == 0 ? s->name : s->name.substr(0, dot)));
    different.insert(names.back());
  }
  if (different.size() == names.size()) return names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] += "_" + std::to_string(i + 1);
  return names;
}

std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

void add_number(std::string& csv, double value) {
  if (std::isnan(value)) return;
  char text[32];
  csv.append(text, std::to_chars(text, text + sizeof text, value + 0.0).ptr);
}

}  // namespace terrane
