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
    for (Index i = 0; i < static_cast<Index>(topology.border.size()); ++i) {
      const Index h = topology.border[i];
      leaving_.push_back({from(h), component[h / 3], to(h), i});
    }
    std::sort(leaving_.begin(), leaving_.end(), [&](const Leaving& p, const Leaving& q) {
      if (p.key() != q.key()) return p.key() < q.key();
      return before(at(p.place), at(p.towards), at(q.towards));
    });
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

  /// A border edge that leaves a place; those of one component at one place stand counter-clockwise.
  struct Leaving {
    Index place, component, towards, edge;
    std::pair<Index, Index> key() const { return {place, component}; }
  };

  /// Of the border edges that leave where edge i arrives: the first one counter-clockwise, on the far side of the void.
  Index next(Index i) const {
    const Index h = topology_.border[i], here = to(h);
    const std::pair<Index, Index> key = {here, component_[h / 3]};
    const auto first =
        std::partition_point(leaving_.begin(), leaving_.end(), [&](const Leaving& l) { return l.key() < key; });
    if (first == leaving_.end() || first->key() != key) return none;
    auto last = first + 1;
    if (last == leaving_.end() || last->key() != key) return first->edge;
    last = std::partition_point(last, leaving_.end(), [&](const Leaving& l) { return l.key() == key; });
    const Point2 o = at(here), back = at(from(h));
    const auto out =
        std::partition_point(first, last, [&](const Leaving& l) { return !before(o, back, at(l.towards)); });
    return out == last ? first->edge : out->edge;
  }

  /// Does the ray from o through p come before the one through q, counter-clockwise from due east?
  static bool before(Point2 o, Point2 p, Point2 q) {
    const auto upper = [&](Point2 r) { return r.y > o.y || (r.y == o.y && r.x > o.x); };
    return upper(p) != upper(q) ? upper(p) : orientation(o, p, q) > 0;
  }

  const Tin& tin_;
  const PlanTopology& topology_;
  const std::vector<Index>& component_;
  std::vector<Leaving> leaving_;
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
