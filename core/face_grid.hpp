// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "core/tin.hpp"

namespace terrane {

/// The faces of a TIN sorted into the cells of a grid, to find those at a place or along a segment. Faces without area
/// in plan, walls among them, are left out. Keeps a reference to the TIN. Built in O(faces + cells), about two faces a
/// cell, 20 bytes a face; a place costs O(1) faces where these are of similar size. Many threads may ask.
class FaceGrid {
 public:
  /// Faces are counter-clockwise.
  explicit FaceGrid(const Tin& tin);

  const Tin& tin() const { return tin_; }
  /// The smallest box around all vertices.
  const Box& box() const { return box_; }

  /// The height of the highest face whose closed plan holds the place, so the upper one at a wall; none outside.
  /// Which faces hold it is decided exactly. A vertex's height is taken as it is.
  std::optional<double> height(Point2 place) const;

  /// The first of the faces whose closed plan holds the place, or none. Exact, as above.
  Index face(Point2 place) const;

  /// Faces in ascending order, among them all whose closed plan meets the segment from a to b.
  std::vector<Index> along(Point2 a, Point2 b) const;

 private:
  /// Visits the faces whose closed plan holds the place.
  template <class Visit>
  void visit_holding(Point2 place, Visit visit) const;
  template <class Visit>
  void visit_cells(const Point2* corners, int count, Visit visit) const;
  int column_of(double x) const;
  int row_of(double y) const;

  const Tin& tin_;
  Box box_{};
  int columns_ = 1, rows_ = 1;
  double cell_x_ = 1, cell_y_ = 1;      // sides of a cell
  double margin_x_ = 0, margin_y_ = 0;  // what rounding may do to a place
  std::vector<std::size_t> first_;      // of cell k: faces_[first_[k]] ... faces_[first_[k + 1] - 1]
  std::vector<Index> faces_;
};

}  // namespace terrane
