// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/tin.hpp"
#include "support/plan_mesh.hpp"

namespace terrane::support {

/// What heights a surface allows near a place: those over the disk of a radius around it, and 4 ulp. Walls are looked
/// through. Doubles with a bound of their error decide first, rationals where they cannot.
class HeightJudge {
 public:
  /// Keeps a reference to the TIN.
  explicit HeightJudge(const Tin& tin);

  /// Whether the surface has a height within 4 ulp of z within `radius` of p, or heights on both sides of it. `guess`:
  /// a face that is looked at first, or none.
  bool allows(Point2 p, double radius, double z, Index guess) const;

  struct Range {
    bool found = false;
    double low = 0, high = 0;
  };
  /// The heights over the disk, a little widened; found: whether some face lies within it.
  Range range(Point2 p, double radius) const;

  /// Whether the border of the domain lies within `radius` of p.
  bool at_border(Point2 p, double radius) const;

  /// The slope of the steepest face that lies within `radius` of p.
  double steepness(Point2 p, double radius) const;

  /// The largest height, either way, at the corners of the faces that lie within `radius` of p.
  double largest(Point2 p, double radius) const;

 private:
  /// Narrowed by `doubt`, the error of long doubles.
  Range quick(std::size_t i, Point2 p, double radius, double& doubt) const;
  Range exact(std::size_t i, Point2 p, double radius) const;
  bool near(std::size_t i, Point2 p, double radius) const;

  const Tin& tin_;
  std::vector<Index> faces_;
  std::vector<Triangle> triangles_;
  std::vector<Box> boxes_;
  std::vector<std::array<Point2, 2>> border_;
};

}  // namespace terrane::support
