// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "core/error.hpp"
#include "io/table.hpp"
#include "io/text.hpp"
#include "io/utf8.hpp"
#include "io/vectors.hpp"

// Tables of places: a first line of names, two of which are x and y, then a place a line.
namespace terrane {
namespace {

/// Takes the next line from the text.
std::string_view next_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = trimmed(text.substr(0, end));
  text = text.substr(std::min(end + 1, text.size()));
  return line;
}

struct Head {
  char separator = 0;
  PlaceColumns columns = {};
  std::vector<std::string> names = {};  // of the other columns; of coordinates empty

  std::size_t least() const { return std::max({columns.x, columns.y, columns.z.value_or(0)}) + 1; }
};

/// Quotes within quotes are doubled.
std::string unquoted(std::string_view cell) {
  std::string text;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    text += cell[i];
    if (cell.substr(i).starts_with("\"\"")) ++i;
  }
  return text;
}

std::optional<Head> head_of(std::string_view line) {
  Head head;
  head.separator = separator_of(line);
  if (head.separator == 0 && line.find('\t') != std::string_view::npos) head.separator = '\t';
  const auto cells = cells_of(line, head.separator);
  const auto columns = columns_by_names(cells);
  if (!columns) return {};
  head.columns = *columns;
  for (std::size_t i = 0; i < cells.size(); ++i)
    head.names.push_back(i == columns->x || i == columns->y || i == columns->z ? "" : unquoted(cells[i]));
  return head;
}

/// A number where it is written as we would, else text: 007 and 1.50 keep their zeros.
nlohmann::json property(std::string_view cell) {
  if (cell.empty()) return nullptr;
  if (number_in(cell))
    if (auto value = nlohmann::json::parse(cell, nullptr, false); value.is_number() && value.dump() == cell)
      return value;
  return unquoted(cell);
}

class Reader {
 public:
  Reader(const std::string& name, Context& context) : name_(name), context_(context) {}

  Vectors read(std::string_view bytes) {
    if (bytes.find('\0') != bytes.npos)
      throw Error(ErrorKind::input, "binary",
                  name_ + ": it holds zero bytes, which text does not; export it as text in UTF-8");
    const std::string decoded = in_utf8(bytes);
    for (std::string_view text = without_mark(decoded); !text.empty();) {
      const std::string_view line = next_line(text);
      ++line_;
      if (const std::string_view crs = crs_in_comment(line); !crs.empty())
        vectors_.crs = declared_crs(crs, name_, context_);
      if (says_nothing(line)) continue;
      if (head_) take(line);
      else head_ = head_of(line);
    }
    if (path_.size() == 1) vectors_.features.push_back({.points = std::move(path_)});
    else if (!path_.empty()) vectors_.features.push_back({.lines = {std::move(path_)}});
    vectors_.lonlat = head_ && head_->columns.lonlat;
    return std::move(vectors_);
  }

 private:
  [[noreturn]] void bad(std::string code, const std::string& what) const {
    throw Error(ErrorKind::input, std::move(code), name_ + ", line " + std::to_string(line_) + ": " + what);
  }

  void take(std::string_view line) {
    context_.stop_if_cancelled();
    const auto cells = cells_of(line, head_->separator);
    if (cells.size() < head_->least())
      bad("truncated", "it has " + std::to_string(cells.size()) + " columns, and " + std::to_string(head_->least()) +
                           " are needed");
    const Point place = place_in(cells);
    if (std::all_of(head_->names.begin(), head_->names.end(), [](const std::string& name) { return name.empty(); })) {
      path_.push_back(place);
      if (path_.size() > max_corners) throw Error(ErrorKind::limit, "too-many-corners", name_ + ": too many places");
      return;
    }
    Feature feature;
    for (std::size_t i = 0; i < std::min(cells.size(), head_->names.size()); ++i)
      if (!head_->names[i].empty()) feature.properties[head_->names[i]] = property(cells[i]);
    feature.points.push_back(place);
    check_features(vectors_, max_features, name_);
    vectors_.features.push_back(std::move(feature));
  }

  Point place_in(const std::vector<std::string_view>& cells) const {
    const auto x = number_in(cells[head_->columns.x]), y = number_in(cells[head_->columns.y]);
    const std::string_view height = head_->columns.z ? cells[*head_->columns.z] : "";
    const auto z = height.empty() ? NAN : number_in(height);
    if (!x || !y || !z) bad("bad-number", "a coordinate is not a finite number, with a point before its decimals");
    return {*x, *y, *z};
  }

  const std::string& name_;
  Context& context_;
  Vectors vectors_;
  std::optional<Head> head_;
  Line path_;  // of a table that has nothing but places
  std::size_t line_ = 0;
};

}  // namespace

bool is_table(std::string_view text) {
  while (!text.empty())
    if (const std::string_view line = next_line(text); !says_nothing(line)) return head_of(line).has_value();
  return false;
}

Vectors read_table(std::string_view bytes, const std::string& name, Context& context) {
  return Reader(name, context).read(bytes);
}

}  // namespace terrane
