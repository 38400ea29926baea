// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/overlay/completed.hpp"

namespace terrane {

/// Measures how deep inside a mesh places lie; quickest when each is near the one before.
class Depth {
 public:
  explicit Depth(const CompletedMesh& mesh) : mesh_(mesh) {}

  /// The distance from p, a place in the box, to the nearest place outside the mesh; infinity when that is beyond
  /// `reach`. Looks at the faces within reach only.
  double at(Point2 p, double reach);

 private:
  const CompletedMesh& mesh_;
  Index last_ = 0;
  std::vector<Index> near_;
};

}  // namespace terrane
