// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/predicates.hpp"
#include "core/tin.hpp"

namespace terrane {

/// Delaunay triangulation of one convex polygon, given counter-clockwise, whose straight corners (on the line of their
/// neighbours) are known combinatorially: every face is positive at the exact places, whatever rounding did to the
/// doubles, and the diagonals are Delaunay on the doubles. Ties go to coordinates, never to numbers. O(k^2) for k
/// corners, k small.
class ConvexTriangulator {
 public:
  /// Calls emit(a, b, c) with the numbers of the corners of every face. Returns whether all are positive on the
  /// doubles. Not all corners are straight; a triangle has none that is.
  template <class Emit>
  bool run(std::span<const Index> corners, std::span<const std::uint8_t> straight, std::span<const Point2> points,
           Emit&& emit) {
    const std::size_t n = corners.size();
    if (n == 3) {
      emit(corners[0], corners[1], corners[2]);
      return orientation(points[corners[0]], points[corners[1]], points[corners[2]]) > 0;
    }
    std::size_t start = 0;  // the closing edge must not lie inside a straight run
    while (start < n && straight[start]) ++start;
    at_.resize(n);
    straight_.resize(n);
    for (std::size_t i = 0, j = start; i < n; ++i, j = j + 1 == n ? 0 : j + 1) {
      at_[i] = points[corners[j]];
      straight_[i] = straight[j];
    }
    all_positive_ = true;
    const auto number = [&](int i) {
      const std::size_t j = start + static_cast<std::size_t>(i);
      return corners[j < n ? j : j - n];
    };
    const auto face = [&](int a, int b, int c) { emit(number(a), number(b), number(c)); };
    if (n == 4 && !(straight_[1] | straight_[2] | straight_[3]))
      quad(face);
    else
      fill(0, static_cast<int>(n) - 1, face);
    return all_positive_;
  }

 private:
  static bool before(Point2 p, Point2 q) { return p.x < q.x || (p.x == q.x && p.y < q.y); }
  bool positive(int a, int b, int c) const { return orientation(at_[a], at_[b], at_[c]) > 0; }

  template <class Emit>
  void quad(Emit&& emit) {
    const bool first = positive(0, 1, 2) && positive(0, 2, 3), second = positive(1, 2, 3) && positive(0, 1, 3);
    bool take_first = first;
    if (first && second) {
      const int inside = in_circle(at_[0], at_[1], at_[2], at_[3]);
      const auto lower = [&](int i, int j) { return before(at_[i], at_[j]) ? at_[i] : at_[j]; };
      take_first = inside < 0 || (inside == 0 && before(lower(0, 2), lower(1, 3)));
    }
    all_positive_ = first || second;
    if (take_first) {
      emit(0, 1, 2);
      emit(0, 2, 3);
    } else {
      emit(1, 2, 3);
      emit(0, 1, 3);
    }
  }

  /// The chain i .. j can close with its chord: it is one edge, or it bends.
  bool closes(int i, int j) const {
    if (j == i + 1) return true;
    for (int m = i + 1; m < j; ++m)
      if (!straight_[m]) return true;
    return false;
  }

  template <class Emit>
  void fill(int i, int j, Emit&& emit) {
    if (j == i + 1) return;
    int best = none;
    bool best_positive = false;
    for (int m = i + 1; m < j; ++m) {
      if (!closes(i, m) || !closes(m, j) || on_closing_side(i, m, j)) continue;
      const bool positive_here = positive(i, m, j);
      bool better = best == none || (positive_here && !best_positive);
      if (!better && positive_here && best_positive) {
        const int inside = in_circle(at_[i], at_[best], at_[j], at_[m]);
        better = inside > 0 || (inside == 0 && before(at_[m], at_[best]));
      }
      if (better) best = m, best_positive = positive_here;
    }
    all_positive_ = all_positive_ && best_positive;
    emit(i, best, j);
    fill(i, best, emit);
    fill(best, j, emit);
  }
  /// m on the line i j? Only the closing side can be such a line: when everything from m to it is straight.
  bool on_closing_side(int i, int m, int j) const {
    if (i != 0 || j != static_cast<int>(at_.size()) - 1) return false;
    for (int k = m + 1; k <= j; ++k)
      if (!straight_[k]) return false;
    return true;
  }

  std::vector<Point2> at_;
  std::vector<std::uint8_t> straight_;
  bool all_positive_ = true;
};

}  // namespace terrane
