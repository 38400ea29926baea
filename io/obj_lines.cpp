// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/obj_lines.hpp"

#include <cstring>

#include "io/text.hpp"

namespace terrane {

void ObjLines::read(const char* p, const char* end, Index most) {
  vertices.clear();
  faces.clear();
  lines = 0;
  furthest = none;
  for (stop = p; end - p > 2 && is_blank(p[1]); stop = p, ++lines) {
    p = *p == 'v' ? read_vertex(p + 1, end) : *p == 'f' ? read_face(p + 1, end, most) : nullptr;
    if (!p) return;
  }
}

/// Behind the line's end; nullptr where it is no such line.
const char* ObjLines::read_vertex(const char* p, const char* end) {
  double xyz[3];
  for (double& value : xyz) {
    p = skip_blanks(p, end);
    p = p == end ? nullptr : parse_number(p, end, value);
    if (!p || p == end || !(is_blank(*p) || *p == '\n')) return nullptr;
  }
  if (*p != '\n') {
    p = static_cast<const char*>(std::memchr(p, '\n', static_cast<std::size_t>(end - p)));
    if (!p) return nullptr;
  }
  vertices.push_back({xyz[0], xyz[1], xyz[2]});
  return p + 1;
}

const char* ObjLines::read_face(const char* p, const char* end, Index most) {
  Face face;
  for (Index& v : face) {
    p = parse_index(skip_blanks(p, end), end, most, v);
    if (!p || v == 0) return nullptr;
    --v;
    if (p != end && *p == '/')
      while (p != end && !is_blank(*p) && *p != '\n') ++p;
    if (p == end || !(is_blank(*p) || *p == '\n')) return nullptr;
  }
  p = skip_blanks(p, end);
  if (p == end || *p != '\n') return nullptr;
  for (Index v : face)
    if (v > furthest) furthest = v, furthest_line = lines + 1;
  faces.push_back(face);
  return p + 1;
}

}  // namespace terrane
