// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "core/area_weights.hpp"
#include "core/sum.hpp"
#include "core/volume.hpp"

namespace terrane {

/// Adds up a Volume face by face: each face is cut where its height difference passes +-tolerance, and every part is
/// integrated in closed form (times the scale).
class VolumeSum {
 public:
  VolumeSum(const AreaWeights& weights, double tolerance) : weights_(weights), tolerance_(tolerance) {}

  /// A face of the overlap, counter-clockwise, with the heights of the surface and of the reference at its corners.
  void add(const std::array<Point2, 3>& plan, const std::array<double, 3>& z, const std::array<double, 3>& reference);
  /// Faces that only one of the two has.
  void add_surface_only(const std::array<Point2, 3>& plan);
  void add_reference_only(const std::array<Point2, 3>& plan);

  Volume result() const;

 private:
  struct Piece {
    std::array<Point2, 3> plan;
    std::array<double, 3> dz;
    double area;
  };
  struct Pieces {  // at most two triangles become four at the first level, those below it eight at the second
    std::array<Piece, 8> all;
    int count = 0;
    void push(const Piece& piece) { all[count++] = piece; }
  };
  struct Side {
    Sum volume, area_2d, area_3d;
    double max_dz = 0;
    VolumeSide value() const { return {volume.value(), area_2d.value(), area_3d.value(), max_dz}; }
  };

  static void cut(const Piece& piece, double level, Pieces& above, Pieces& below);
  static void add_piece(Side& side, const Piece& piece, const std::array<double, 3>& w, double sign, double slope);
  void add_side(Side& side, const Pieces& pieces, double sign, double slope);

  const AreaWeights& weights_;
  double tolerance_;
  Side fill_, cut_, same_;
  Sum surface_integral_, reference_integral_, overlap_, surface_only_, reference_only_;
};

}  // namespace terrane
