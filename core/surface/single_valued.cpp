// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/surface/single_valued.hpp"

namespace terrane {

std::optional<Tin> single_valued(const CornerSurface& surface) {
  Tin tin;
  tin.vertices.reserve(surface.points.size());
  for (const Point2& p : surface.points) tin.vertices.push_back({p.x, p.y, 0});
  for (std::size_t c = 0; c < surface.z.size(); ++c) tin.vertices[surface.faces[c / 3][c % 3]].z = surface.z[c];
  for (std::size_t c = 0; c < surface.z.size(); ++c)
    if (tin.vertices[surface.faces[c / 3][c % 3]].z != surface.z[c]) return {};
  tin.faces.assign(surface.faces.begin(), surface.faces.end());
  return tin;
}

}  // namespace terrane
