// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <utility>

#include "core/mesh/array.hpp"
#include "core/parallel.hpp"
#include "core/predicates.hpp"
#include "core/topology.hpp"
#include "core/validate.hpp"

namespace terrane {
namespace {

/// The parts of the domain that hang together over shared edges, each known by its lowest face.
class Components {
 public:
  Components(const PlanTopology& topology, const Context& context) : lower_(topology.turn.size()) {
    const std::size_t n = lower_.size(), chunk = chunk_for(context, n);
    std::vector<std::vector<std::array<Index, 2>>> across(n / chunk + 1);  // faces of two ranges that share an edge
    parallel_for(context, n, chunk, [&](std::size_t begin, std::size_t end) {
      for (auto f = static_cast<Index>(begin); f < static_cast<Index>(end); ++f) {
        lower_[f] = f;
        for (Index h = 3 * f; h < 3 * f + 3; ++h) {
          if (topology.mate[h] < 0 || topology.mate[h] > h) continue;
          const Index g = topology.mate[h] / 3;
          if (g < static_cast<Index>(begin))
            across[begin / chunk].push_back({f, g});
          else if (lower_[f] == f)
            lower_[f] = lower_[g];
          else if (lower_[f] != lower_[g])
            join(f, g);
        }
      }
    });
    for (const auto& pairs : across)
      for (const auto& [f, g] : pairs) join(f, g);
  }

  /// The part that a face belongs to.
  Index of(Index f) {
    while (lower_[f] != f) f = lower_[f] = lower_[lower_[f]];
    return f;
  }
  bool is_lowest(Index f) const { return lower_[f] == f; }

 private:
  void join(Index f, Index g) {
    f = of(f), g = of(g);
    lower_[std::max(f, g)] = std::min(f, g);
  }

  Array<Index> lower_;  // a face of the same part, itself where there is no lower one
};

/// Follows the border of each component around the voids beside it, so that rings that touch in a point stay apart, as
/// in a polygon of the simple feature model.
class BorderRings {
 public:
  BorderRings(const Tin& tin, const PlanTopology& topology, Components& components)
      : tin_(tin), topology_(topology), components_(components) {
    for (Index i = 0; i < static_cast<Index>(topology.border.size()); ++i) {
      const Index h = topology.border[i];
      leaving_.push_back({from(h), components.of(h / 3), to(h), i});
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
    const std::pair<Index, Index> key = {here, components_.of(h / 3)};
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
  Components& components_;
  std::vector<Leaving> leaving_;
};

/// The components and holes of a sound surface by its border alone: where no place has two edges of it leaving, each of
/// its rings is the outer one of a component or that of a hole. False, and nothing counted, where some place has.
bool count_rings(const Tin& tin, std::vector<BorderHalfEdge> border, Inspection& result) {
  const auto less = [](const BorderHalfEdge& a, const BorderHalfEdge& b) { return a.from < b.from; };
  std::sort(border.begin(), border.end(), less);
  const auto twice = [](const BorderHalfEdge& a, const BorderHalfEdge& b) { return a.from == b.from; };
  if (std::adjacent_find(border.begin(), border.end(), twice) != border.end()) return false;
  const auto following = [&](std::size_t i) {
    return static_cast<std::size_t>(
        std::lower_bound(border.begin(), border.end(), BorderHalfEdge{0, border[i].to, 0}, less) - border.begin());
  };
  const auto at = [&](Index v) { return plan(tin.vertices[v]); };
  std::vector<bool> seen(border.size(), false);
  for (std::size_t start = 0; start < border.size(); ++start) {
    if (seen[start]) continue;
    // The domain has less than a straight angle at the lowest vertex of an outer ring, and more at that of a hole.
    std::size_t arriving = start;
    Point2 lowest = at(border[start].to);
    for (std::size_t i = start; !seen[i]; i = following(i)) {
      seen[i] = true;
      const Point2 p = at(border[i].to);
      if (std::pair(p.y, p.x) < std::pair(lowest.y, lowest.x)) arriving = i, lowest = p;
    }
    const bool outer = orientation(at(border[arriving].from), lowest, at(border[following(arriving)].to)) > 0;
    ++(outer ? result.components : result.holes);
  }
  return true;
}

/// Whether the surface is as a result should be; what there is to count is then known of its border alone.
bool inspect_sound(const Tin& tin, Inspection& result, const Context& context) {
  const auto border = sound_border(tin, context);
  return border && examine_border(tin, *border, 0).sound() && count_rings(tin, *border, result);
}

void count_faces(const PlanTopology& topology, const Components& components, Inspection& result,
                 const Context& context) {
  const std::size_t n = topology.turn.size(), chunk = chunk_for(context, n);
  std::vector<Inspection> parts(n / chunk + 1);
  parallel_for(context, n, chunk, [&](std::size_t begin, std::size_t end) {
    Inspection part;
    for (auto f = static_cast<Index>(begin); f < static_cast<Index>(end); ++f) {
      const Turn turn = topology.turn[f];
      part.walls += turn == Turn::wall;
      part.inverted += turn == Turn::right;
      part.degenerate += turn == Turn::flat || turn == Turn::unusable;
      part.components += topology.in_plan(f) && components.is_lowest(f);
    }
    parts[begin / chunk] = part;
  });
  for (const Inspection& part : parts) {
    result.walls += part.walls;
    result.inverted += part.inverted;
    result.degenerate += part.degenerate;
    result.components += part.components;
  }
}

}  // namespace

Inspection inspect(const Tin& tin, const Context& context) {
  Inspection result;
  result.vertices = tin.vertices.size();
  result.faces = tin.faces.size();
  if (inspect_sound(tin, result, context)) return result;
  const PlanTopology topology = plan_topology(tin, context);
  result.non_manifold_edges = topology.crowded.size();
  const BorderReport border = examine_border(tin, border_edges(tin, topology), 0);
  result.t_junctions = border.touches.size();
  result.overlaps = border.crossings + border.doubled_regions;
  Components components(topology, context);
  count_faces(topology, components, result, context);
  const std::size_t rings = BorderRings(tin, topology, components).count();
  result.holes = rings - std::min(result.components, rings);
  return result;
}

}  // namespace terrane
