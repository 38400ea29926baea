// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <optional>

#include "io/bad_input.hpp"
#include "io/format_list.hpp"
#include "io/table.hpp"
#include "io/text.hpp"

// Tables of points: one a line, columns apart by commas, semicolons, tabs or blanks. Which columns are x, y and z is
// said by `columns`, else by a first line of names, else they are the first three.
namespace terrane {
namespace {

struct Columns {
  std::size_t x = 0, y = 1, z = 2;
  std::size_t least() const { return std::max({x, y, z}) + 1; }
};

/// "PNEZD": P a name, N or Y the northing, E or X the easting, Z the height, D words; anything else is passed over.
std::optional<Columns> columns_by_letters(std::string_view letters) {
  std::optional<std::size_t> x, y, z;
  for (std::size_t i = 0; i < letters.size(); ++i) {
    const char letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letters[i])));
    std::optional<std::size_t>* slot = letter == 'X' || letter == 'E'   ? &x
                                       : letter == 'Y' || letter == 'N' ? &y
                                       : letter == 'Z'                  ? &z
                                                                        : nullptr;
    if (slot && *slot) return {};
    if (slot) *slot = i;
  }
  if (!x || !y || !z) return {};
  return Columns{*x, *y, *z};
}

/// A table of points needs all three.
std::optional<Columns> three_columns(const std::vector<std::string_view>& cells) {
  const auto named = columns_by_names(cells);
  if (!named || !named->z) return {};
  return Columns{named->x, named->y, *named->z};
}

class Reader {
 public:
  Reader(Source source, const ReadOptions& options, Context& context)
      : source_(std::move(source)), options_(options), context_(context) {}

  Dataset read() {
    if (!options_.columns.empty()) {
      const auto columns = columns_by_letters(options_.columns);
      if (!columns)
        throw Error(ErrorKind::usage, "bad-parameter",
                    "parameter 'columns' is '" + options_.columns.substr(0, 40) +
                        "'; it names each column by a letter: X or E, Y or N and Z once, others such as P and D are "
                        "passed over");
      columns_ = *columns;
      known_ = true;
    }
    source_.skip_mark();
    for (std::string_view block = source_.block("\n"); !block.empty(); block = source_.block("\n")) {
      context_.progress("read", source_.fraction());
      while (!block.empty()) {
        const std::size_t end = std::min(block.find('\n'), block.size());
        ++line_;
        take(trimmed(block.substr(0, end)));
        block = block.substr(std::min(end + 1, block.size()));
      }
    }
    if (cloud_.points.empty()) bad_input(options_, "empty", "", "there is no point in the table");
    return {std::move(cloud_), crs_};
  }

 private:
  void take(std::string_view line) {
    if (const std::string_view crs = crs_in_comment(line); !crs.empty()) crs_ = declared_crs(crs, options_, context_);
    if (says_nothing(line)) return;
    const auto cells = cells_of(line, separator_of(line));
    if (!known_ && !number_in(cells.front())) {
      // Names stand once, before all points; with `columns` given a line of them is passed over all the same.
      if (const auto columns = three_columns(cells); columns && cloud_.points.empty()) {
        columns_ = *columns;
        known_ = true;
        return;
      }
    }
    const auto place = "line " + std::to_string(line_);
    if (cells.size() < columns_.least())
      bad_input(options_, "truncated", place,
                "it has " + std::to_string(cells.size()) + " columns, and " + std::to_string(columns_.least()) +
                    " are needed; name them with columns, as in columns=PNEZD");
    const auto x = number_in(cells[columns_.x]), y = number_in(cells[columns_.y]), z = number_in(cells[columns_.z]);
    if (!x || !y || !z) {
      if (cloud_.points.empty() && three_columns(cells)) return;
      bad_input(options_, "bad-number", place,
                "a coordinate is not a finite number; name the columns with columns, as in columns=PNEZD");
    }
    check_count(options_, cloud_.points.size() + 1, options_.max_vertices, "points");
    cloud_.points.push_back({*x, *y, *z});
  }

  Source source_;
  const ReadOptions& options_;
  Context& context_;
  Columns columns_;
  bool known_ = false;
  std::size_t line_ = 0;
  PointCloud cloud_;
  Crs crs_;
};

/// A first line of three numbers or more, or of names.
bool is_table(std::string_view head) {
  std::string_view text = without_mark(head);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, end));
    text = text.substr(std::min(end + 1, text.size()));
    if (says_nothing(line)) continue;
    const auto cells = cells_of(line, separator_of(line));
    if (three_columns(cells)) return true;
    return cells.size() >= 3 && std::all_of(cells.begin(), cells.begin() + 3, [](auto c) { return !!number_in(c); });
  }
  return false;
}

}  // namespace

Format point_table_format() {
  return {"xyz",
          {".xyz", ".csv", ".txt"},
          "text/csv",
          "Points, one a line; a first line may name the columns, or the parameter columns does (XYZ, ENZ, PNEZD).",
          [](Source source, const ReadOptions& options, Context& context) {
            return Reader(std::move(source), options, context).read();
          },
          nullptr,
          is_table};
}

}  // namespace terrane
