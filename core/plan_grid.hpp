// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/context.hpp"
#include "core/overlay.hpp"
#include "core/tin.hpp"

// A TIN with its plan coordinates on a grid: rounded and verified like an overlay's crossings, all vertices moving.
namespace terrane {

/// The multiples of a step, each as the double nearest to it: of 0.001 the doubles that print with three decimals.
class PlanGrid {
 public:
  /// `step` > 0 and finite.
  explicit PlanGrid(double step);
  double step() const { return step_; }
  /// The multiple nearest to x; x itself where multiples lie closer than doubles. Of a multiple, itself.
  double nearest(double x) const;
  Point2 nearest(Point2 p) const { return {nearest(p.x), nearest(p.y)}; }

 private:
  double step_, numerator_, denominator_;  // step = numerator / denominator, whole numbers where it is a short decimal
};

struct OnGrid {
  Tin tin;                  // canonical
  RoundingReport rounding;  // max_move: of any vertex; max_spill: of any face's corner from the face it lies on
  double area_lost = 0;     // in plan; negative when some was gained
};

/// Moves every vertex to the grid point nearest to it, with its height. Promises: every x and y is a multiple of the
/// step; every face is strictly positive, exactly, or a wall; no T-junction, no edge with more faces than before; the
/// exterior is rounded as faces are, so that borders do not cross: gaps and slivers narrower than the grid close.
/// Vertices that come to lie on one grid point become one, with the heights of the one that had most of them. Walls are
/// built anew where heights jump if the TIN has any; else jumps stay open. Precondition: valid and canonical (core/
/// validate). The result depends on the TIN alone. O(n) where the grid is finer than the faces, about 5 us per vertex
/// where it is not. Throws Error{input, "grid"} naming the step when no face is left, or some face cannot be kept
/// positive.
OnGrid put_on_grid(const Tin& tin, const PlanGrid& grid, Context& context);

}  // namespace terrane
