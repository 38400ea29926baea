// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/context.hpp"
#include "core/tin.hpp"
#include "ops/outcome.hpp"

// Heights of a TIN at places, found without the overlay: the independent way by which results are checked.
namespace terrane {

class HeightField {
 public:
  /// Keeps a reference to the TIN. O(n log n). The more faces a cell has the less is built, and the longer a question
  /// takes: two for a question per face, more for a few thousand in all.
  explicit HeightField(const Tin& tin, int faces_per_cell = 2);

  struct Reading {
    bool found = false;  // a face lies within the radius
    bool border = false;  // so does the border of the domain
    HeightRange height;  // over the faces within the radius, at their nearest points
  };
  /// Heights at a place, or within `radius` of it. Walls are looked through.
  Reading at(Point2 place, double radius) const;

  /// No face at all.
  bool empty() const { return tin_.faces.empty(); }
  /// Places on the border are from now on inside like any other.
  void take_border_for_inside() { border_.assign(border_.size(), false); }
  /// The smallest box around all vertices.
  const Box& box() const { return box_; }

  /// The edges of the domain's border, the domain on the left.
  const std::vector<std::array<Point2, 2>>& border() const { return border_edges_; }

  /// The height of the nearest face among those near the place: for places a straight edge leaves outside.
  std::optional<double> nearest(Point2 place) const;

 private:
  struct Hit {
    double distance2, z;
    bool border;
  };
  /// Faces that follow each other, and lie near each other where the TIN is in canonical order.
  struct Run {
    Box box;
    Index first, last;
  };
  Box box_of(Index face) const;
  void list(const Run& run);
  void list_apart(Index face);
  void list_in_row(int row, double xlow, double xhigh);
  Hit hit(Index face, Point2 place, double radius) const;
  /// The faces in the cells that a box lies in, but for those in runs apart from `near`.
  template <class Visit>
  void visit_cells(Box box, Box near, Visit visit) const;

  const Tin& tin_;
  std::vector<bool> border_;  // per half-edge 3 * face + corner
  std::vector<std::array<Point2, 2>> border_edges_;
  Box box_{};
  int columns_ = 1, rows_ = 1;
  double cell_x_ = 1, cell_y_ = 1;  // sides of a cell
  double per_x_ = 1, per_y_ = 1;    // cells per unit of length
  struct Listed {
    Index run, next;
  };
  std::vector<Run> runs_;
  std::vector<Index> first_;  // per cell: where its list of runs begins in listed_, or none
  std::vector<Listed> listed_;
};

/// Fields for a few thousand questions each, made side by side.
HeightFields height_fields(const std::vector<const Tin*>& tins, Context& context);

}  // namespace terrane
