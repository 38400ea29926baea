// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/json_rows.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "io/text.hpp"

namespace terrane {

namespace {

/// Behind a character and the spaces before it; nullptr where there is another.
const char* pass(const char* p, const char* end, char c) {
  p = skip_spaces(p, end);
  return p != end && *p == c ? p + 1 : nullptr;
}

const char* read_value(const char* p, const char* end, double& value) {
  return p == end ? nullptr : parse_number(p, end, value);
}
const char* read_value(const char* p, const char* end, Index& value) {
  return parse_index(p, end, std::numeric_limits<Index>::max(), value);
}

template <class Value>
const char* read_row(const char* p, const char* end, Value& a, Value& b, Value& c) {
  char before = '[';
  for (Value* value : {&a, &b, &c}) {
    p = pass(p, end, std::exchange(before, ','));
    p = p ? read_value(skip_spaces(p, end), end, *value) : nullptr;
    if (!p) return nullptr;
  }
  p = pass(p, end, ']');
  return p ? pass(p, end, ',') : nullptr;
}

const char* read_row(const char* p, const char* end, Point& row) { return read_row(p, end, row.x, row.y, row.z); }
const char* read_row(const char* p, const char* end, Face& row) { return read_row(p, end, row[0], row[1], row[2]); }

}  // namespace

template <class Row>
void JsonRows<Row>::read(const char* p, const char* end, std::size_t most) {
  rows.clear();
  Row row;
  for (stop = p; rows.size() < most && (p = read_row(p, end, row)); stop = p) rows.push_back(row);
}

template struct JsonRows<Point>;
template struct JsonRows<Face>;

const char* end_of_row(const char* p, const char* end) {
  for (p = std::find(p, end, ']'); p != end; p = std::find(p, end, ']')) {
    p = skip_spaces(p + 1, end);
    if (p != end && *p == ',') return p + 1;
  }
  return end;
}

}  // namespace terrane
