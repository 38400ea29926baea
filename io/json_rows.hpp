// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "core/tin.hpp"

namespace terrane {

/// The rows that Terrane JSON is full of, `[x,y,z],`, read without looking at the rows before them, so that several
/// threads can read one array. Row is Point, three finite numbers, or Face, three vertex indices.
template <class Row>
struct JsonRows {
  std::vector<Row> rows;
  const char* stop = nullptr;  // behind the comma of the last row read

  /// Reads rows that a comma follows, up to `most`, and up to the first that is anything else, a wrong one too. What was
  /// read before is forgotten.
  void read(const char* p, const char* end, std::size_t most);
};

extern template struct JsonRows<Point>;
extern template struct JsonRows<Face>;

/// Behind the next bracket and comma, where a row of the array begins; the end where there are none.
const char* end_of_row(const char* p, const char* end);

}  // namespace terrane
