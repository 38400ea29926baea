// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/predicates.hpp"
#include "core/tin.hpp"

namespace terrane {

/// Delaunay triangulation of one convex polygon, given counter-clockwise, whose flat corners (on the line of their
/// neighbours) are known combinatorially: every face is positive at the exact places, whatever rounding did to the
/// doubles, and the diagonals are Delaunay on the doubles. Ties go to coordinates, never to numbers. O(k^2) for k
/// corners, k small.
template <class PointOf, class Emit>
class ConvexTriangulator {
 public:
  ConvexTriangulator(std::span<const Index> corners, const std::vector<bool>& flat, PointOf point_of, Emit emit)
      : corners_(corners), flat_(flat), point_of_(point_of), emit_(emit) {}

  void run() {
    const int n = static_cast<int>(corners_.size());
    if (n == 3) return emit_(corners_[0], corners_[1], corners_[2]);
    int start = 0;  // the closing edge must not lie inside a straight run
    while (start < n && flat_[start]) ++start;
    start_ = start;
    fill(0, n - 1);
  }

 private:
  Index corner(int i) const { return corners_[(start_ + i) % corners_.size()]; }
  Point2 at(int i) const { return point_of_(corner(i)); }
  bool is_flat(int i) const { return flat_[(start_ + i) % corners_.size()]; }
  /// The chain i .. j can close with its chord: it is one edge, or it bends.
  bool closes(int i, int j) const {
    if (j == i + 1) return true;
    for (int m = i + 1; m < j; ++m)
      if (!is_flat(m)) return true;
    return false;
  }
  static bool before(Point2 p, Point2 q) { return p.x < q.x || (p.x == q.x && p.y < q.y); }

  void fill(int i, int j) {
    if (j == i + 1) return;
    int best = none;
    bool best_positive = false;
    for (int m = i + 1; m < j; ++m) {
      if (!closes(i, m) || !closes(m, j) || straight(i, m, j)) continue;
      const bool positive = orientation(at(i), at(m), at(j)) > 0;
      bool better = best == none || (positive && !best_positive);
      if (!better && positive == best_positive && positive) {
        const int inside = in_circle(at(i), at(best), at(j), at(m));
        better = inside > 0 || (inside == 0 && before(at(m), at(best)));
      }
      if (better) best = m, best_positive = positive;
    }
    emit_(corner(i), corner(best), corner(j));
    fill(i, best);
    fill(best, j);
  }
  /// m on the line i j? Only the closing side can be such a line: when everything from m to it is flat.
  bool straight(int i, int m, int j) const {
    if (i != 0 || j != static_cast<int>(corners_.size()) - 1) return false;
    for (int k = m + 1; k <= j; ++k)
      if (!is_flat(k)) return false;
    return true;
  }

  std::span<const Index> corners_;
  const std::vector<bool>& flat_;
  PointOf point_of_;
  Emit emit_;
  int start_ = 0;
};

}  // namespace terrane
