// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/tin.hpp"

// A constrained Delaunay triangulation on integer places. Sums and products of lattice places are exact in 64 bits (128
// for the in-circle test of very large lattices), so no decision can fail.
namespace terrane {

/// Column and row of a sample; y counts upwards, so that counter-clockwise here is counter-clockwise on the map.
struct LatticePoint {
  std::int32_t x = 0, y = 0;
  bool operator==(const LatticePoint&) const = default;
};

/// Twice the signed area of a b c, exact.
inline std::int64_t area2(LatticePoint a, LatticePoint b, LatticePoint c) {
  return (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) - (std::int64_t{b.y} - a.y) * (std::int64_t{c.x} - a.x);
}

struct LatticeTriangle {
  std::array<Index, 3> v;  // counter-clockwise
  std::array<Index, 3> n;  // n[k]: the triangle across the edge opposite v[k]; negative: the mesh ends there
};

/// A border edge; the domain lies to its left.
using LatticeEdge = std::array<Index, 2>;

class LatticeMesh {
 public:
  std::vector<LatticePoint> points;
  std::vector<LatticeTriangle> triangles;

  /// The rectangle of a lattice as two triangles.
  LatticeMesh(int width, int height);

  /// Cuts the mesh down to the domain that `edges` enclose. Edges must not cross nor pass through a vertex. The first
  /// four points of the mesh are the rectangle's corners, used or not. Expected O(n log n) for border vertices as they
  /// occur.
  void cut_out(const std::vector<LatticePoint>& border, const std::vector<LatticeEdge>& edges);

  /// Inserts p, which lies in triangle t or on its edge and is no vertex, and restores the Delaunay property. Returns
  /// one triangle around p; all changed triangles lie around p and have it as v[0].
  Index insert(LatticePoint p, Index t);

  /// Lawson's flips from the edges opposite corner k of t, for each {t, k}: where these are the only ones that may not
  /// be Delaunay, no edge is that may be turned.
  void restore_delaunay(std::vector<std::array<Index, 2>> edges);

  /// Calls visit(triangle) for all triangles around v[0] of t, which must be v[0] of all of them.
  template <class Visit>
  void around(Index t, Visit visit) const {
    Index s = t;
    do {
      visit(s);
      s = triangles[s].n[1];
    } while (s >= 0 && s != t);
    if (s == t) return;
    for (s = triangles[t].n[2]; s >= 0; s = triangles[s].n[2]) visit(s);
  }

 private:
  bool in_circle(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d) const;
  void replace_neighbour(Index t, Index old, Index now);
  void flip(Index t, int k);
  void legalize();

  Index locate_or_insert(LatticePoint p, Index& hint);
  void index_vertices();
  std::array<Index, 2> find_edge(Index u, Index v) const;
  bool enforce(Index u, Index v);
  void keep_inside(const std::vector<std::array<Index, 2>>& border);

  bool wide_;                       // the in-circle test needs 128 bits
  std::vector<Index> pending_;      // triangles whose edge opposite v[0] is to be tested
  std::vector<Index> triangle_of_;  // any triangle of a vertex; only while cutting out
};

}  // namespace terrane
