// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/table.hpp"

#include <algorithm>
#include <array>

#include "io/text.hpp"

namespace terrane {
namespace {

/// Where the cell that begins at `begin` ends: at the next separator that no quotes enclose.
std::size_t end_of_cell(std::string_view line, std::size_t begin, char separator) {
  bool quoted = false;
  for (std::size_t i = begin; i < line.size(); ++i)
    if (line[i] == '"' && (quoted || trimmed(line.substr(begin, i - begin)).empty())) quoted = !quoted;
    else if (line[i] == separator && !quoted) return i;
  // A quote that nothing closes is one like any other character.
  return quoted ? std::min(line.find(separator, begin), line.size()) : line.size();
}

std::string_view without_quotes(std::string_view cell) {
  const bool quoted = cell.size() > 1 && cell.front() == '"' && cell.back() == '"';
  return quoted ? cell.substr(1, cell.size() - 2) : cell;
}

}  // namespace

char separator_of(std::string_view line) {
  for (const char c : {';', ','})
    if (line.find(c) != std::string_view::npos) return c;
  return 0;
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  if (separator == 0) {
    for (const char *p = line.data(), *const end = p + line.size(); (p = skip_blanks(p, end)) != end;) {
      const char* first = p;
      while (p != end && !is_blank(*p)) ++p;
      cells.push_back(without_quotes({first, static_cast<std::size_t>(p - first)}));
    }
    return cells;
  }
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = end_of_cell(line, begin, separator);
    cells.push_back(without_quotes(trimmed(line.substr(begin, end - begin))));
    begin = end + 1;
  }
  return cells;
}

std::optional<double> number_in(std::string_view cell) {
  double value = 0;
  const char* end = cell.data() + cell.size();
  if (cell.empty() || parse_number(cell.data(), end, value) != end) return {};
  return value;
}

std::optional<PlaceColumns> columns_by_names(const std::vector<std::string_view>& cells) {
  // Longitude and latitude last.
  constexpr std::array<std::string_view, 7> xs = {"x", "easting", "east", "e", "lon", "longitude", "long"};
  constexpr std::array<std::string_view, 6> ys = {"y", "northing", "north", "n", "lat", "latitude"};
  constexpr std::array<std::string_view, 7> zs = {"z", "elevation", "elev", "height", "h", "alt", "altitude"};
  constexpr std::size_t planar = 4;
  struct Found {
    std::size_t column, word;
  };
  const auto find = [&](const auto& names) -> std::optional<Found> {
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (const auto it = std::find(names.begin(), names.end(), lower(cells[i])); it != names.end())
        return Found{i, static_cast<std::size_t>(it - names.begin())};
    return {};
  };
  const auto x = find(xs), y = find(ys), z = find(zs);
  if (!x || !y) return {};
  return PlaceColumns{x->column, y->column, z ? std::optional(z->column) : std::nullopt,
                      x->word >= planar && y->word >= planar};
}

bool says_nothing(std::string_view line) {
  return line.empty() || line.front() == '#' || line.front() == '%' || line.starts_with("//");
}

std::string_view crs_in_comment(std::string_view line) {
  if (line.empty() || (line.front() != '#' && line.front() != '%')) return "";
  const std::string_view text = trimmed(line.substr(1));
  return lower(text.substr(0, 4)) == "crs:" ? trimmed(text.substr(4)) : "";
}

}  // namespace terrane
