// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "core/overlay/completed.hpp"

namespace terrane {

/// Measures how deep inside a mesh places lie; quickest when each is near the one before. Looks at the faces within
/// reach only.
class Depth {
 public:
  /// Deeper than `reach` is infinitely deep, and deeper than `enough` is not looked for any more.
  Depth(const CompletedMesh& mesh, double reach, double enough)
      : mesh_(mesh), reach_(reach), enough_(enough), visited_(mesh.faces()) {}

  /// The largest distance of a place of a face in the box, or of a single place, from the nearest place outside the
  /// mesh: of its corners, and of edges that come close to the border at both ends, for a part of the mesh may stand
  /// between these.
  double of(std::span<const Point2> corners);

 private:
  struct Seen {
    double depth = 0;
    std::vector<Index> border;  // edges of the border that are not farther than `enough`
  };
  /// `way` from `from`: seen from there, places within rounding of each other are told apart.
  Seen look(Point2 from, Point2 way);
  /// The depth of what lies between two fractions of the way, as far as it has to be looked at.
  double between(Point2 from, Point2 way, double start, const Seen& at_start, double stop, const Seen& at_stop);

  const CompletedMesh& mesh_;
  double reach_, enough_;
  /// Of places asked for before: a far one that many faces have in common would be walked to from each, and back.
  std::map<std::pair<double, double>, Seen> seen_;
  Index last_ = 0;
  std::vector<Index> near_;    // the faces within reach of the last place
  std::vector<bool> visited_;  // per face, while they are gathered
};

}  // namespace terrane
