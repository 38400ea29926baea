// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/half_edges.hpp"

#include <algorithm>

#include "core/topology.hpp"

namespace terrane {
namespace {

void copy_faces(const Tin& tin, const PlanTopology& topology, bool across_jumps, HalfEdges& mesh) {
  std::vector<Index> number(tin.faces.size(), none);
  for (std::size_t f = 0; f < tin.faces.size(); ++f) {
    if (topology.turn[f] != Turn::left) continue;
    number[f] = static_cast<Index>(mesh.faces.size());
    mesh.faces.push_back(tin.faces[f]);
  }
  mesh.mate.assign(3 * mesh.faces.size(), none);
  for (std::size_t f = 0; f < tin.faces.size(); ++f) {
    if (number[f] == none) continue;
    for (Index k = 0; k < 3; ++k) {
      const Index h = 3 * static_cast<Index>(f) + k, m = topology.mate[h];
      if (m < 0 || topology.turn[m / 3] != Turn::left) continue;
      const bool joined = topology.from(tin, h) == topology.to(tin, m) && topology.to(tin, h) == topology.from(tin, m);
      if (joined || across_jumps) mesh.mate[3 * number[f] + k] = 3 * number[m / 3] + m % 3;
    }
  }
}

}  // namespace

HalfEdges half_edges(const Tin& tin, const Context& context, bool across_jumps) {
  HalfEdges mesh;
  copy_faces(tin, plan_topology(tin, context), across_jumps, mesh);
  mesh.out.assign(tin.vertices.size(), none);
  const auto count = static_cast<Index>(mesh.mate.size());
  for (Index h = 0; h < count; ++h)
    if (mesh.mate[h] != none && mesh.out[mesh.from(h)] == none) mesh.out[mesh.from(h)] = h;
  std::vector<Index> several;  // half-edges of borders that are not the first at their vertex
  for (Index h = 0; h < count; ++h) {
    if (mesh.mate[h] != none) continue;
    Index& out = mesh.out[mesh.from(h)];
    if (out == none || mesh.mate[out] != none)
      out = h;
    else
      several.push_back(h);
  }
  std::sort(several.begin(), several.end(),
            [&](Index a, Index b) { return std::pair(mesh.from(a), a) < std::pair(mesh.from(b), b); });
  mesh.other_fans = std::move(several);
  return mesh;
}

}  // namespace terrane
