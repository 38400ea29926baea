// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay/heights.hpp"

#include "core/parallel.hpp"
#include "core/triangle_height.hpp"

namespace terrane {

void place_vertices(Arrangement& arrangement, Context& context) {
  const std::size_t n = arrangement.first_crossing;
  parallel_for(context, n, chunk_for(context, n), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const int m = static_cast<Index>(v) >= arrangement.first_b;
      const Index place = arrangement.place_of_vertex[v];
      arrangement.points[v] = arrangement.mesh[m]->at(place);
      arrangement.heights[m][v] = arrangement.mesh[m]->z[place];
      arrangement.heights[1 - m][v] = arrangement.location[m][place].z;
    }
  });
}

double FaceHeights::at(Index face, Index vertex, Point2 p) const {
  Index place = none, edge = none;
  if (vertex >= arrangement_.first_crossing) {
    edge = arrangement_.edge_through(m_, arrangement_.node_of(vertex));
  } else {
    const int own = vertex >= arrangement_.first_b;
    place = arrangement_.place_of_vertex[vertex];
    if (own != m_) {
      const Location& where = arrangement_.location[own][place];
      place = where.kind == Location::place ? where.index : none;
      if (where.kind == Location::edge) edge = mesh_.edge_of(where.index);
    }
  }
  for (int k = 0; k < 3; ++k) {
    const Index h = 4 * face + k;
    if (place != none && mesh_.corner(h) == place) return z(face, k);
    if (edge == none || mesh_.edge_of(h) != edge) continue;
    // Along the defining half-edge, so that the faces on both sides agree to the last bit.
    int from = k, to = (k + 1) % 3;
    if (mesh_.against(h)) std::swap(from, to);
    return mix(z(face, from), z(face, to),
               fraction_along(mesh_.at(mesh_.corner(4 * face + from)), mesh_.at(mesh_.corner(4 * face + to)), p));
  }
  const Index* c = mesh_.links[face].corner;
  return height_on_triangle({mesh_.at(c[0]), mesh_.at(c[1]), mesh_.at(c[2])}, {z(face, 0), z(face, 1), z(face, 2)}, p);
}

HeightError FaceHeights::error(Index face, double max_move) const {
  const Index* c = mesh_.links[face].corner;
  return height_error({mesh_.at(c[0]), mesh_.at(c[1]), mesh_.at(c[2])}, {z(face, 0), z(face, 1), z(face, 2)}, max_move);
}

double FaceHeights::distance(Index face, Point2 p) const {
  const Index* c = mesh_.links[face].corner;
  return distance_to_triangle({mesh_.at(c[0]), mesh_.at(c[1]), mesh_.at(c[2])}, p);
}

}  // namespace terrane
