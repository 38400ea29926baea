// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>

#include "core/sum.hpp"
#include "core/volume.hpp"
#include "core/volume/area_weights.hpp"

namespace terrane {

/// Adds up a Volume face by face: each face is cut where its height difference passes +-tolerance, and every part is
/// integrated in closed form (times the scale).
class VolumeSum {
 public:
  VolumeSum(const AreaWeights& weights, double tolerance) : weights_(weights), tolerance_(tolerance) {}

  /// A face of the overlap, counter-clockwise, and what of it no reference changes.
  struct Face {
    std::array<Point2, 3> plan;
    std::array<double, 3> z, weights;  // of the surface at its corners
    double area, slope;
  };
  static Face face(const std::array<Point2, 3>& plan, const std::array<double, 3>& z, const AreaWeights& weights);
  /// With the heights of the reference at its corners.
  void add(const Face& face, const std::array<double, 3>& reference);
  void add(const std::array<Point2, 3>& plan, const std::array<double, 3>& z, const std::array<double, 3>& reference) {
    add(face(plan, z, weights_), reference);
  }

  /// Faces that lie above a level as a whole, or below it.
  struct Wholes {
    Sum volume, area_2d, area_3d, integral;  // the volume to the level, never negative; the integral of z
    double lowest = INFINITY, highest = -INFINITY;

    /// A face, and where its level is.
    void add(const Face& face, double level);
    /// All that `nearer` has, of a level that is nearer to them by `step`.
    void add(const Wholes& nearer, double step);
  };
  void add_above(const Wholes& wholes, double level) { add(fill_, wholes, wholes.highest - level, level); }
  void add_below(const Wholes& wholes, double level) { add(cut_, wholes, level - wholes.lowest, level); }

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

  void add(Side& side, const Wholes& wholes, double max_dz, double level);
  static void cut(const Piece& piece, double level, Pieces& above, Pieces& below);
  static void add_piece(Side& side, const Piece& piece, const std::array<double, 3>& w, double sign, double slope);
  void add_side(Side& side, const Pieces& pieces, double sign, double slope);

  const AreaWeights& weights_;
  double tolerance_;
  Side fill_, cut_, same_;
  Sum surface_integral_, reference_integral_, overlap_, surface_only_, reference_only_;
};

}  // namespace terrane
