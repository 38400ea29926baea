// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/toe.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "core/plan/region_fill.hpp"
#include "core/topology.hpp"

namespace terrane {

Tin toe_surface(const Tin& tin, const Context& context) {
  const PlanTopology topology = plan_topology(tin, context);
  Tin toe{tin.vertices, {}};
  for (std::size_t v = 0; v < tin.vertices.size(); ++v) {
    double& foot = toe.vertices[topology.place[v]].z;
    foot = std::min(foot, tin.vertices[v].z);
  }
  std::vector<Point2> points;
  points.reserve(tin.vertices.size());
  for (const Point& p : tin.vertices) points.push_back(plan(p));
  std::vector<BorderEdge> border;
  for (const BorderHalfEdge& e : border_edges(tin, topology)) border.push_back({e.from, e.to});
  FilledRegion filled = fill_region(points, border);
  if (!filled.sound)
    throw Error(ErrorKind::input, "border", "the border of the surface crosses itself; validate repair=true mends it");
  toe.faces = std::move(filled.faces);
  return canonical(std::move(toe), context);
}

}  // namespace terrane
