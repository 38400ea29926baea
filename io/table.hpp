// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string_view>
#include <vector>

// Rows of tables as text: cells apart by commas, semicolons, tabs or blanks.
namespace terrane {

/// What stands between the cells of a line: ';', else ',', else (0) any blanks.
char separator_of(std::string_view line);

/// The cells of a line, without the blanks and quotes around them; what is quoted may hold the separator. After 0, for
/// any blanks, no cell is empty.
std::vector<std::string_view> cells_of(std::string_view line, char separator);

/// The finite number that a cell is.
std::optional<double> number_in(std::string_view cell);

/// Which columns are coordinates.
struct PlaceColumns {
  std::size_t x = 0, y = 1;
  std::optional<std::size_t> z = {};
  bool lonlat = false;  // they are called longitude and latitude
};

/// By a line of names ("x", "Easting", "lon", …, in any case); none where it does not name both x and y.
std::optional<PlaceColumns> columns_by_names(const std::vector<std::string_view>& cells);

/// A line without points: empty, or a comment.
bool says_nothing(std::string_view line);

/// The CRS that a comment line "# crs: EPSG:25831" declares; empty where it does not.
std::string_view crs_in_comment(std::string_view line);

}  // namespace terrane
