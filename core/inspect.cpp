// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/sum.hpp"
#include "core/topology.hpp"
#include "core/validate.hpp"

namespace terrane {
namespace {

/// The parts of the domain that hang together over shared edges.
std::size_t count_components(const PlanTopology& topology) {
  const auto n = static_cast<Index>(topology.turn.size());
  std::vector<Index> root(n);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](Index f) {
    while (root[f] != f) f = root[f] = root[root[f]];
    return f;
  };
  std::size_t components = 0;
  for (Index f = 0; f < n; ++f) components += topology.in_plan(f);
  for (Index h = 0; h < static_cast<Index>(topology.mate.size()); ++h) {
    if (topology.mate[h] <= h) continue;
    const Index a = find(h / 3), b = find(topology.mate[h] / 3);
    if (a == b) continue;
    root[std::max(a, b)] = std::min(a, b);
    --components;
  }
  return components;
}

/// The closed curves of the border. Where it touches itself the curve stays with its faces, so that each component has
/// exactly one outer curve and every other is a hole.
std::size_t count_loops(const PlanTopology& topology) {
  std::vector<bool> seen(topology.border.size(), false);
  const auto number = [&](Index h) {
    return std::lower_bound(topology.border.begin(), topology.border.end(), h) - topology.border.begin();
  };
  std::size_t loops = 0;
  for (const Index start : topology.border) {
    if (seen[number(start)]) continue;
    ++loops;
    for (Index h = start; !seen[number(h)];) {
      seen[number(h)] = true;
      h = topology.next(h);
      while (topology.mate[h] >= 0) h = topology.next(topology.mate[h]);
    }
  }
  return loops;
}

void measure(const Tin& tin, const PlanTopology& topology, Inspection& result) {
  Sum area_2d, area_3d;
  for (std::size_t f = 0; f < tin.faces.size(); ++f) {
    if (!topology.in_plan(static_cast<Index>(f))) continue;
    const Point &a = tin.vertices[tin.faces[f][0]], &b = tin.vertices[tin.faces[f][1]], &c = tin.vertices[tin.faces[f][2]];
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
  result.components = count_components(topology);
  const std::size_t loops = count_loops(topology);
  result.holes = loops - std::min(result.components, loops);
  measure(tin, topology, result);
  return result;
}

}  // namespace terrane
