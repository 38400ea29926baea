// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/tin.hpp"

// Polygons by GEOS, an overlay that shares nothing with ours but the question.
namespace terrane::support {

class Polygons {
 public:
  /// Throws std::runtime_error when it is no WKT of polygons.
  static Polygons from_wkt(const std::string& wkt);
  /// One polygon per ring.
  static Polygons from_rings(const std::vector<std::vector<Point2>>& rings);
  /// The union of a TIN's faces in plan.
  static Polygons from_domain(const Tin& tin);

  /// Empty when they are valid in the sense of OGC, else why they are not.
  std::string invalidity() const;
  /// Made valid: every ring counts by its parity.
  Polygons repaired() const;
  double area() const;
  /// Throw std::runtime_error where GEOS gives up.
  double united_area(const Polygons& other) const;
  double shared_area(const Polygons& other) const;

  /// Shells and holes, the last point not repeated.
  std::vector<std::vector<Point2>> rings() const;

 private:
  explicit Polygons(void* geometry);
  std::shared_ptr<void> geometry_;
};

/// The constrained Delaunay triangulation of what lies within an odd number of rings, level. Throws std::exception when
/// rings cross between their vertices.
Tin triangulated(const std::vector<std::vector<Point2>>& rings);

}  // namespace terrane::support
