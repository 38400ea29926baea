// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/surface/mend.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace terrane {
namespace {

/// The vertices that stand at the places touched.
class Columns {
 public:
  Columns(Tin& tin, const PlanTopology& topology, const std::vector<BorderReport::Touch>& touches) : tin_(tin) {
    for (const auto& touch : touches) vertices_[touch.place];
    for (Index v = 0; v < static_cast<Index>(tin.vertices.size()); ++v) {
      const auto at = vertices_.find(topology.place[v]);
      if (at != vertices_.end()) at->second.push_back(v);
    }
  }

  /// The vertex at a place on the edge from a to b whose height is that of the edge; made when there is none.
  Index on_edge(Index place, Index a, Index b) {
    const Point p = tin_.vertices[a], q = tin_.vertices[b];
    Point made = tin_.vertices[place];
    const double t =
        std::fabs(q.x - p.x) > std::fabs(q.y - p.y) ? (made.x - p.x) / (q.x - p.x) : (made.y - p.y) / (q.y - p.y);
    made.z = std::clamp(p.z + t * (q.z - p.z), std::min(p.z, q.z), std::max(p.z, q.z));
    std::vector<Index>& column = vertices_.at(place);
    Index nearest = none;
    for (const Index v : column) {
      const double gap = std::fabs(tin_.vertices[v].z - made.z);
      if (gap > height_rounding(made.z)) continue;
      if (nearest == none || gap < std::fabs(tin_.vertices[nearest].z - made.z)) nearest = v;
    }
    if (nearest != none) return nearest;
    tin_.vertices.push_back(made);
    column.push_back(static_cast<Index>(tin_.vertices.size()) - 1);
    return column.back();
  }

 private:
  Tin& tin_;
  std::map<Index, std::vector<Index>> vertices_;
};

/// A counter-clockwise triangle with the vertices that stand on its sides; side k runs from corner k to the next.
struct Touched {
  Face corners;
  std::array<std::vector<Index>, 3> sides;
};

/// Cuts a touched triangle into plain ones: each vertex on a side is joined with the opposite corner of what is left.
void split(Touched whole, std::vector<Face>& parts) {
  std::vector<Touched> stack;
  stack.push_back(std::move(whole));
  while (!stack.empty()) {
    Touched t = std::move(stack.back());
    stack.pop_back();
    int k = 0;
    while (k < 3 && t.sides[k].empty()) ++k;
    if (k == 3) {
      parts.push_back(t.corners);
      continue;
    }
    const Index a = t.corners[k], b = t.corners[(k + 1) % 3], c = t.corners[(k + 2) % 3];
    std::vector<Index>& side = t.sides[k];
    Touched near{{a, side.front(), c}, {{{}, {}, std::move(t.sides[(k + 2) % 3])}}};
    Touched far{{side.front(), b, c}, {{{side.begin() + 1, side.end()}, std::move(t.sides[(k + 1) % 3]), {}}}};
    stack.push_back(std::move(far));
    stack.push_back(std::move(near));
  }
}

}  // namespace

double height_rounding(double z) { return 1e-9 * std::max(1.0, std::fabs(z)); }

std::vector<std::pair<Index, Index>> weld_duplicates(Tin& tin, const Array<Index>& places,
                                                     const std::vector<bool>& used) {
  const auto n = static_cast<Index>(tin.vertices.size());
  std::vector<bool> shared(n, false);
  std::vector<Index> crowd;
  for (Index v = 0; v < n; ++v)
    if (places[v] != v) shared[places[v]] = true;
  for (Index v = 0; v < n; ++v)
    if (used[v] && shared[places[v]]) crowd.push_back(v);
  std::sort(crowd.begin(), crowd.end(), [&](Index a, Index b) {
    if (places[a] != places[b]) return places[a] < places[b];
    return tin.vertices[a].z != tin.vertices[b].z ? tin.vertices[a].z < tin.vertices[b].z : a < b;
  });
  std::vector<std::pair<Index, Index>> welded;
  for (std::size_t i = 0; i < crowd.size();) {
    const double lowest = tin.vertices[crowd[i]].z;
    std::size_t end = i + 1;
    Index kept = crowd[i];
    while (end < crowd.size() && places[crowd[end]] == places[crowd[i]] &&
           tin.vertices[crowd[end]].z - lowest <= height_rounding(lowest))
      kept = std::min(kept, crowd[end++]);
    tin.vertices[kept].z = lowest;
    for (; i < end; ++i)
      if (crowd[i] != kept) welded.emplace_back(crowd[i], kept);
  }
  std::sort(welded.begin(), welded.end());
  if (welded.empty()) return welded;
  std::vector<Index> to(n);
  for (Index v = 0; v < n; ++v) to[v] = v;
  for (const auto& [gone, kept] : welded) to[gone] = kept;
  for (Face& face : tin.faces)
    for (Index& v : face) v = to[v];
  return welded;
}

void split_at_touches(Tin& tin, const PlanTopology& topology, const std::vector<BorderReport::Touch>& touches,
                      std::vector<Index>& originals) {
  Columns columns(tin, topology, touches);
  std::vector<Face> parts;
  for (std::size_t i = 0; i < touches.size();) {
    const Index face = touches[i].half_edge / 3;
    Touched whole;
    Index h = 3 * face;
    for (int k = 0; k < 3; ++k, h = topology.next(h)) {
      whole.corners[k] = topology.from(tin, h);
      for (std::size_t j = i; j < touches.size() && touches[j].half_edge / 3 == face; ++j)
        if (touches[j].half_edge == h)
          whole.sides[k].push_back(columns.on_edge(touches[j].place, topology.from(tin, h), topology.to(tin, h)));
    }
    while (i < touches.size() && touches[i].half_edge / 3 == face) ++i;
    parts.clear();
    split(std::move(whole), parts);
    tin.faces[face] = parts.front();
    for (std::size_t p = 1; p < parts.size(); ++p) {
      tin.faces.push_back(parts[p]);
      originals.push_back(originals[face]);
    }
  }
}

}  // namespace terrane
