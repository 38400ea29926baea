// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "core/tin.hpp"

namespace terrane {

/// The lines that OBJ files are full of, read without looking at the lines before them, so that several threads can read
/// one file: `v x y z` and `f i j k` with indices from 1 up, which may carry texture and normal indices.
struct ObjLines {
  std::vector<Point> vertices;
  std::vector<Face> faces;
  std::size_t lines = 0;
  Index furthest = none;  // the largest index
  std::size_t furthest_line = 0;  // the line where it is first used, counted from 1
  const char* stop = nullptr;     // behind the last line read

  /// Reads lines that end in a newline up to the first that is anything else, a wrong one too, or has an index above
  /// `most`. What was read before is forgotten.
  void read(const char* p, const char* end, Index most);

 private:
  const char* read_vertex(const char* p, const char* end);
  const char* read_face(const char* p, const char* end, Index most);
};

}  // namespace terrane
