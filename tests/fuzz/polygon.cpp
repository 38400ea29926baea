// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>

#include "fuzz/require.hpp"
#include "io/polygon.hpp"

// libFuzzer on polygons with corners on a 16 x 16 lattice, one per byte: what is triangulated has faces of one
// orientation that have the polygon's area between them.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace terrane;
  using fuzz::require;
  std::vector<Point> vertices;
  std::vector<Index> corners;
  for (std::size_t i = 0; i < size; ++i) {
    vertices.push_back({static_cast<double>(data[i] >> 4), static_cast<double>(data[i] & 15), 0});
    corners.push_back(static_cast<Index>(i));
  }
  std::vector<Face> faces(1);
  if (!append_polygon(faces, vertices, corners)) {
    require(faces.size() == 1, "no face of a polygon that is refused");
    return 0;
  }
  require(faces.size() == size - 1, "two faces less than corners");
  double polygon = 0, total = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const Point &p = vertices[i], &q = vertices[(i + 1) % size];
    polygon += p.x * q.y - p.y * q.x;
  }
  for (std::size_t f = 1; f < faces.size(); ++f) {
    const Point &a = vertices[faces[f][0]], &b = vertices[faces[f][1]], &c = vertices[faces[f][2]];
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    total += area;
    require(area * polygon >= 0, "faces of one orientation");
  }
  require(total == polygon, "the area of the polygon");
  return 0;
}
