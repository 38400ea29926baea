// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "core/simplify/deviation.hpp"

namespace terrane {

/// What is left when a vertex is taken out of a mesh, and how it is filled again.
class StarPatch {
 public:
  explicit StarPatch(const Deviation& deviation) : deviation_(deviation) {}

  /// The corners of the hole, counter-clockwise. Open: the vertex lay on the border, which will run from the last to
  /// the first corner.
  std::vector<Index> ring;
  bool open = false;
  /// Vertices taken out before that the hole covers, and the one taken out now.
  std::vector<Index> covered;

  /// Counter-clockwise, indices into `ring`.
  std::vector<std::array<int, 3>> triangles;

  /// Triangulates the hole so that the surface stays within `limit` of the original, with corners as wide as that
  /// allows: the Delaunay triangulation where it does, else the best of all those that do. Returns the largest
  /// deviation, infinite where nothing serves. The same ring gives the same triangles. O(r^3) for r corners and the
  /// time of measuring; r log r above `many`, where the constrained Delaunay triangulation alone is tried.
  double fill(double limit);

  static constexpr int many = 32;

 private:
  bool best_triangulation(double limit, bool checked);
  bool delaunay_of_many();
  bool triangle_allowed(int i, int m, int j, double limit) const;
  bool inner(int i, int j) const { return j - i > 1 && (open || i > 0 || j < static_cast<int>(ring.size()) - 1); }
  double along(int i, int j, double limit);
  double measured(double limit);
  void collect(int i, int j);

  struct Cell {
    double cost;  // of the best triangulation of corners i ... j
    int apex;     // of its triangle on the edge from i to j
    double off;   // what along() said of that edge, and for which limit; below 0: not asked yet
  };
  Cell& cell(int i, int j) { return cells_[i * ring.size() + j]; }

  const Deviation& deviation_;
  std::vector<Cell> cells_;
  std::vector<Point2> places_;
};

}  // namespace terrane
