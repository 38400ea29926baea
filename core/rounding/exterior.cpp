// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rounding/exterior.hpp"

#include "core/box.hpp"
#include "core/plan/region_fill.hpp"

namespace terrane {

void add_exterior(PlanarMesh& mesh, const std::function<ExactPlace(Index)>& place) {
  std::vector<BorderEdge> outside;  // the border as the exterior sees it: the outside on the left
  Box box = no_box;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      if (mesh.neighbours[f][k] != none) continue;
      outside.push_back({mesh.faces[f][(k + 2) % 3], mesh.faces[f][(k + 1) % 3]});
      box = around(box, mesh.points[outside.back().from]);  // every end of the border is the start of an edge
    }
  box = frame_around(box);
  const Index n = static_cast<Index>(mesh.points.size());
  for (const Point2 corner :
       {Point2{box.xmin, box.ymin}, Point2{box.xmax, box.ymin}, Point2{box.xmax, box.ymax}, Point2{box.xmin, box.ymax}})
    mesh.points.push_back(corner);
  for (Index k = 0; k < 4; ++k) outside.push_back({n + k, n + (k + 1) % 4});
  const auto place_or_corner = [&](Index v) { return v < n ? place(v) : ExactPlace{}; };
  const FilledRegion filled = fill_region_exactly(mesh.points, place_or_corner, outside);
  if (!filled.sound) {
    mesh.points.resize(n);
    return;
  }
  mesh.faces.insert(mesh.faces.end(), filled.faces.begin(), filled.faces.end());
  mesh.labels.resize(mesh.faces.size(), none);
  connect(mesh);
}

}  // namespace terrane
