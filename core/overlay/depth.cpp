// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay/depth.hpp"

#include <algorithm>
#include <limits>

#include "core/triangle_height.hpp"

namespace terrane {

double Depth::at(Point2 p, double reach) {
  last_ = face_at(mesh_, locate(mesh_, p, last_));
  if (!mesh_.real(last_)) return 0;
  double least = std::numeric_limits<double>::infinity();
  near_.assign(1, last_);
  for (std::size_t i = 0; i < near_.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const Index h = 4 * near_[i] + k, beyond = mesh_.twin(h) >> 2;
      double distance;
      nearest_on_segment(mesh_.at(mesh_.origin(h)), mesh_.at(mesh_.target(h)), p, distance);
      if (distance > reach) continue;
      if (!mesh_.real(beyond))
        least = std::min(least, distance);
      else if (std::find(near_.begin(), near_.end(), beyond) == near_.end())
        near_.push_back(beyond);
    }
  return least;
}

}  // namespace terrane
