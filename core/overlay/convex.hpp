// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/plan/place_order.hpp"
#include "core/predicates.hpp"
#include "core/tin.hpp"

namespace terrane {

/// Delaunay triangulation of one convex polygon, given counter-clockwise, whose straight corners (on the line of their
/// neighbours) are known combinatorially: every face is positive at the exact places, whatever rounding did to the
/// doubles, and the diagonals are Delaunay on the doubles. Ties go to coordinates, never to numbers. O(k^2) for k
/// corners, k small.
class ConvexTriangulator {
 public:
  /// Calls emit(a, b, c) with the numbers of the corners of each of the n - 2 faces. `straight`: per corner; empty when
  /// none is; never all, and none of a triangle. Returns whether all faces are positive on the doubles.
  template <class Emit>
  bool run(std::span<const Index> corners, std::span<const std::uint8_t> straight, const Point2* points, Emit&& emit) {
    const std::size_t n = corners.size();
    const auto at = [&](std::size_t i) { return points[corners[i]]; };
    if (n == 3) {
      emit(corners[0], corners[1], corners[2]);
      return orientation(at(0), at(1), at(2)) > 0;
    }
    if (n == 4 && straight.empty()) return quad(corners, at(0), at(1), at(2), at(3), emit);
    std::size_t start = 0;  // the closing edge must not lie inside a straight run
    while (!straight.empty() && straight[start]) ++start;
    at_.resize(n);
    straight_.resize(n);
    for (std::size_t i = 0, j = start; i < n; ++i, j = j + 1 == n ? 0 : j + 1) {
      at_[i] = at(j);
      if (!straight.empty()) straight_[i] = straight[j];
    }
    all_positive_ = true;
    const auto number = [&](int i) {
      const std::size_t j = start + static_cast<std::size_t>(i);
      return corners[j < n ? j : j - n];
    };
    const auto emit_numbers = [&](int a, int b, int c) { emit(number(a), number(b), number(c)); };
    if (straight.empty())
      fill<false>(0, static_cast<int>(n) - 1, emit_numbers);
    else
      fill<true>(0, static_cast<int>(n) - 1, emit_numbers);
    return all_positive_;
  }

 private:
  bool positive(int a, int b, int c) const { return orientation(at_[a], at_[b], at_[c]) > 0; }

  template <class Emit>
  static bool quad(std::span<const Index> c, Point2 p, Point2 q, Point2 r, Point2 s, Emit&& emit) {
    const auto lower = [](Point2 u, Point2 v) { return before(u, v) ? u : v; };
    const int inside = in_circle(p, q, r, s);
    bool along_pr = inside < 0 || (inside == 0 && before(lower(p, r), lower(q, s)));
    // One diagonal is as likely as the other: the corners are picked without a branch.
    const auto positive = [&] {
      return orientation(p, q, along_pr ? r : s) > 0 && orientation(along_pr ? p : q, r, s) > 0;
    };
    bool sound = positive();
    if (!sound) {
      along_pr = !along_pr;
      sound = positive();
      if (!sound) along_pr = !along_pr;
    }
    emit(c[0], c[1], c[along_pr ? 2 : 3]);
    emit(c[along_pr ? 0 : 1], c[2], c[3]);
    return sound;
  }

  /// The chain i .. j can close with its chord: it is one edge, or it bends.
  bool closes(int i, int j) const {
    if (j == i + 1) return true;
    for (int m = i + 1; m < j; ++m)
      if (!straight_[m]) return true;
    return false;
  }

  template <bool any_straight, class Emit>
  void fill(int i, int j, const Emit& emit) {
    if (j == i + 1) return;
    int best = none;
    bool best_positive = false;
    for (int m = i + 1; m < j; ++m) {
      if (any_straight && (!closes(i, m) || !closes(m, j) || on_closing_side(i, m, j))) continue;
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
    fill<any_straight>(i, best, emit);
    fill<any_straight>(best, j, emit);
  }
  /// m on the line i j? Only the closing side can be such a line: when everything from m to it is straight.
  bool on_closing_side(int i, int m, int j) const {
    if (i != 0 || j != static_cast<int>(at_.size()) - 1) return false;
    for (int k = m + 1; k <= j; ++k)
      if (!straight_[k]) return false;
    return true;
  }

  std::vector<Point2> at_;
  std::vector<std::uint8_t> straight_;  // meaningless in fill<false>
  bool all_positive_ = true;
};

}  // namespace terrane
