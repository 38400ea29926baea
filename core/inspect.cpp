// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/predicates.hpp"
#include "core/sum.hpp"
#include "core/topology.hpp"
#include "core/validate.hpp"

namespace terrane {
namespace {

/// The parts of the domain that hang together over shared edges: per face the lowest face of its part.
std::vector<Index> components_of(const PlanTopology& topology) {
  std::vector<Index> root(topology.turn.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](Index f) {
    while (root[f] != f) f = root[f] = root[root[f]];
    return f;
  };
  for (Index h = 0; h < static_cast<Index>(topology.mate.size()); ++h) {
    if (topology.mate[h] <= h) continue;
    const Index a = find(h / 3), b = find(topology.mate[h] / 3);
    if (a != b) root[std::max(a, b)] = std::min(a, b);
  }
  for (Index& r : root) r = root[r];  // parents come before their children
  return root;
}

/// Follows the border of each component around the voids beside it, so that rings that touch in a point stay apart, as
/// in a polygon of the simple feature model.
class BorderRings {
 public:
  BorderRings(const Tin& tin, const PlanTopology& topology, const std::vector<Index>& component)
      : tin_(tin), topology_(topology), component_(component) {
    for (std::size_t i = 0; i < topology.border.size(); ++i)
      leaving_.push_back({from(topology.border[i]), static_cast<Index>(i)});
    std::sort(leaving_.begin(), leaving_.end());
  }

  std::size_t count() const {
    std::vector<bool> seen(topology_.border.size(), false);
    std::size_t rings = 0;
    for (Index start = 0; start < static_cast<Index>(seen.size()); ++start) {
      rings += !seen[start];
      for (Index i = start; i != none && !seen[i]; i = next(i)) seen[i] = true;
    }
    return rings;
  }

 private:
  Index from(Index h) const { return topology_.place[topology_.from(tin_, h)]; }
  Index to(Index h) const { return topology_.place[topology_.to(tin_, h)]; }
  Point2 at(Index place) const { return plan(tin_.vertices[place]); }

  /// Of the border edges that leave where edge i arrives: the first one counter-clockwise, on the far side of the void.
  Index next(Index i) const {
    const Index h = topology_.border[i], here = to(h);
    Index best = none;
    for (auto out = std::lower_bound(leaving_.begin(), leaving_.end(), std::pair(here, Index{0}));
         out != leaving_.end() && out->first == here; ++out) {
      const Index other = topology_.border[out->second];
      if (component_[other / 3] != component_[h / 3]) continue;
      if (best == none || sooner(at(here), at(from(h)), at(to(other)), at(to(topology_.border[best]))))
        best = out->second;
    }
    return best;
  }

  /// Does the ray from o through p come before the one through q, counter-clockwise from the ray through back?
  static bool sooner(Point2 o, Point2 back, Point2 p, Point2 q) {
    const bool beyond_p = orientation(o, back, p) < 0,
               beyond_q = orientation(o, back, q) < 0;  // more than half a turn away
    return beyond_p != beyond_q ? beyond_q : orientation(o, p, q) > 0;
  }

  const Tin& tin_;
  const PlanTopology& topology_;
  const std::vector<Index>& component_;
  std::vector<std::pair<Index, Index>> leaving_;  // (place, which border edge leaves it)
};

void measure(const Tin& tin, const PlanTopology& topology, Inspection& result) {
  Sum area_2d, area_3d;
  for (std::size_t f = 0; f < tin.faces.size(); ++f) {
    if (!topology.in_plan(static_cast<Index>(f))) continue;
    const Point &a = tin.vertices[tin.faces[f][0]], &b = tin.vertices[tin.faces[f][1]],
                &c = tin.vertices[tin.faces[f][2]];
    const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z, vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
    const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    area_2d.add(0.5 * std::fabs(nz));
    area_3d.add(0.5 * std::sqrt(nx * nx + ny * ny + nz * nz));
  }
  result.area_2d = area_2d.value();
  result.area_3d = area_3d.value();
}

}  // namespace

Inspection inspect(const Tin& tin) {
  Inspection result;
  result.vertices = tin.vertices.size();
  result.faces = tin.faces.size();
  result.box = bounds(tin);
  if (!tin.vertices.empty()) {
    const auto by_z = [](const Point& p, const Point& q) { return p.z < q.z; };
    const auto [low, high] = std::minmax_element(tin.vertices.begin(), tin.vertices.end(), by_z);
    result.zmin = low->z, result.zmax = high->z;
  }
  const PlanTopology topology = plan_topology(tin);
  for (const Turn turn : topology.turn) {
    result.walls += turn == Turn::wall;
    result.inverted += turn == Turn::right;
    result.degenerate += turn == Turn::flat || turn == Turn::unusable;
  }
  result.non_manifold_edges = topology.crowded.size();
  const BorderReport border = examine_border(tin, topology, 0);
  result.t_junctions = border.touches.size();
  result.overlaps = border.crossings + border.doubled_regions;
  const std::vector<Index> component = components_of(topology);
  for (Index f = 0; f < static_cast<Index>(component.size()); ++f)
    result.components += topology.in_plan(f) && component[f] == f;
  const std::size_t rings = BorderRings(tin, topology, component).count();
  result.holes = rings - std::min(result.components, rings);
  measure(tin, topology, result);
  return result;
}

}  // namespace terrane
