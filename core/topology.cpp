// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/topology.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/box.hpp"
#include "core/mesh/chains.hpp"
#include "core/mesh/hilbert.hpp"
#include "core/parallel.hpp"
#include "core/predicates.hpp"

namespace terrane {
namespace {

bool finite(const Point& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

/// Which cell of a square lattice with about one vertex per cell a vertex is in. Equal coordinates have equal cells.
class Cells {
 public:
  explicit Cells(const std::vector<Point>& vertices) {
    double xmin = INFINITY, ymin = INFINITY, xmax = -INFINITY, ymax = -INFINITY;
    for (const Point& p : vertices) {
      if (!finite(p)) continue;
      xmin = std::min(xmin, p.x), xmax = std::max(xmax, p.x);
      ymin = std::min(ymin, p.y), ymax = std::max(ymax, p.y);
    }
    side_ = std::max<Index>(1, static_cast<Index>(std::sqrt(static_cast<double>(vertices.size()))));
    x0_ = xmin, y0_ = ymin;
    sx_ = scale(xmax - xmin), sy_ = scale(ymax - ymin);
  }
  Index count() const { return side_ * side_; }
  Index of(const Point& p) const { return column(p.y, y0_, sy_) * side_ + column(p.x, x0_, sx_); }

 private:
  double scale(double width) const {  // an overflowing or empty width puts everything in one cell, which is only slower
    const double s = side_ / width;
    return std::isfinite(s) ? s : 0;
  }
  Index column(double v, double v0, double s) const {
    const double c = (v - v0) * s;
    return c >= 0 && c < side_ ? static_cast<Index>(c) : side_ - 1;
  }
  Index side_ = 1;
  double x0_ = 0, y0_ = 0, sx_ = 0, sy_ = 0;
};

Turn turn_of(const Tin& tin, const Array<Index>& place, const Face& face) {
  const auto n = static_cast<Index>(tin.vertices.size());
  for (const Index v : face)
    if (v < 0 || v >= n || !finite(tin.vertices[v])) return Turn::unusable;
  const std::array<Index, 3> at = {place[face[0]], place[face[1]], place[face[2]]};
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3;
    if (at[k] != at[l]) continue;
    const bool upright = tin.vertices[face[k]].z != tin.vertices[face[l]].z && at[(k + 2) % 3] != at[k];
    return upright ? Turn::wall : Turn::flat;
  }
  const Point &a = tin.vertices[face[0]], &b = tin.vertices[face[1]], &c = tin.vertices[face[2]];
  const int sign = orientation(plan(a), plan(b), plan(c));
  return sign > 0 ? Turn::left : sign < 0 ? Turn::right : Turn::flat;
}

using PlanEdges = std::vector<std::array<Index, 2>>;

/// What ranges found, one after another.
template <class T>
std::vector<T> joined(std::vector<std::vector<T>>& parts) {
  for (std::size_t i = 1; i < parts.size(); ++i) parts[0].insert(parts[0].end(), parts[i].begin(), parts[i].end());
  return std::move(parts[0]);
}

/// A half-edge as its lower end sees it.
struct Spoke {
  Index other;  // the higher end
  Index code;   // the half-edge when it runs towards the higher end, its complement when it comes from there
  bool outward() const { return code >= 0; }
  Index half_edge() const { return code >= 0 ? code : ~code; }
};

/// Pairs the half-edges of one plan edge: all of them run between the same two places.
void pair_up(Spoke* first, Spoke* last, Index low, PlanTopology& topology, PlanEdges& crowded) {
  const auto count = last - first;
  if (count == 2 && first->outward() != first[1].outward()) {
    topology.mate[first->half_edge()] = first[1].half_edge();
    topology.mate[first[1].half_edge()] = first->half_edge();
    return;
  }
  if (count == 1) return;
  Spoke* inward = std::stable_partition(first, last, [](const Spoke& s) { return s.outward(); });
  crowded.push_back({low, first->other});
  for (Spoke *out = first, *in = inward; out != inward && in != last; ++out, ++in) {
    topology.mate[out->half_edge()] = in->half_edge();
    topology.mate[in->half_edge()] = out->half_edge();
  }
}

/// The same for all edges of a vertex, where they are few and no side of one has two faces, as at most vertices. False,
/// and nothing done, where that is not so.
bool pair_few(const std::vector<Spoke>& spokes, PlanTopology& topology) {
  constexpr std::size_t few = 16;
  const std::size_t n = spokes.size();
  if (n > few) return false;
  std::size_t twin[few];
  for (std::size_t i = 0; i < n; ++i) {
    twin[i] = i;
    for (std::size_t j = i + 1; j < n; ++j) {
      if (spokes[j].other != spokes[i].other) continue;
      if (twin[i] != i || spokes[j].outward() == spokes[i].outward()) return false;
      twin[i] = j;
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (twin[i] == i) continue;
    const Index h = spokes[i].half_edge(), mate = spokes[twin[i]].half_edge();
    topology.mate[h] = mate;
    topology.mate[mate] = h;
  }
  return true;
}

/// Judges the faces and hangs their half-edges at the lower end of each.
Chains hang_half_edges(const Tin& tin, PlanTopology& topology, const Context& context) {
  const std::size_t n = tin.faces.size();
  topology.turn.resize(n);
  return chains(tin.vertices.size(), 3 * n, n, context, [&](std::size_t begin, std::size_t end, const auto& hang) {
    for (auto f = static_cast<Index>(begin); f < static_cast<Index>(end); ++f) {
      const Face& face = tin.faces[f];
      topology.turn[f] = turn_of(tin, topology.place, face);
      if (!topology.in_plan(f)) continue;
      const Face at = {topology.place[face[0]], topology.place[face[1]], topology.place[face[2]]};
      for (Index k = 0; k < 3; ++k) hang(std::min(at[k], at[k == 2 ? 0 : k + 1]), 3 * f + k);
    }
  });
}

/// Takes the chain at a vertex apart: its half-edges, each as yet without a mate.
void take_spokes(const Tin& tin, Index low, Index chain, PlanTopology& topology, std::vector<Spoke>& spokes) {
  spokes.clear();
  while (chain != none) {
    const Index h = chain, f = h / 3, k = h - 3 * f;
    chain = std::exchange(topology.mate[h], no_mate);
    const Index a = topology.place[tin.faces[f][k]], b = topology.place[tin.faces[f][k == 2 ? 0 : k + 1]];
    const bool outward = (a == low) != (topology.turn[f] == Turn::right);
    spokes.push_back({a == low ? b : a, outward ? h : ~h});
  }
}

/// Pairs the half-edges that hang at a range of vertices.
PlanEdges pair_range(const Tin& tin, const Array<Index>& first, const Chains::Range& range, PlanTopology& topology) {
  const auto before = [](const Spoke& a, const Spoke& b) {
    return a.other != b.other ? a.other < b.other : a.half_edge() < b.half_edge();
  };
  PlanEdges crowded;
  std::vector<Spoke> spokes;
  for (Index v = range.low; v < range.high; ++v) {
    if (first[v] == none) continue;
    take_spokes(tin, v, first[v], topology, spokes);
    if (pair_few(spokes, topology)) continue;
    std::sort(spokes.begin(), spokes.end(), before);
    for (Spoke *spoke = spokes.data(), *last = spoke + spokes.size(); spoke != last;) {
      Spoke* end = spoke + 1;
      while (end != last && end->other == spoke->other) ++end;
      pair_up(spoke, end, v, topology, crowded);
      spoke = end;
    }
  }
  return crowded;
}

/// The half-edges without a mate among those of a range of faces.
std::vector<Index> border_of(std::size_t begin, std::size_t end, PlanTopology& topology) {
  std::vector<Index> border;
  for (auto f = static_cast<Index>(begin); f < static_cast<Index>(end); ++f)
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      if (!topology.in_plan(f)) topology.mate[h] = no_half_edge;
      if (topology.mate[h] == no_mate) border.push_back(h);
    }
  return border;
}

/// The same as places() below, where it needs no sorting: vertices stand along the Hilbert curve, so that equal places
/// are neighbours. Empty when they do not, or some are not finite.
Array<Index> places_along_curve(const std::vector<Point>& vertices, const Context& context) {
  const std::size_t n = vertices.size(), chunk = chunk_for(context, n);
  const HilbertCurve curve(bounds(vertices, context));
  std::atomic<bool> along = true;
  Array<Index> place(n);
  parallel_for(context, n, chunk, [&](std::size_t begin, std::size_t end) {
    std::size_t first = begin;  // at the place of the vertex before
    while (first > 0 && plan(vertices[first - 1]) == plan(vertices[begin])) --first;
    std::uint64_t last = begin > 0 ? curve.key(vertices[begin - 1].x, vertices[begin - 1].y) : 0;
    for (std::size_t v = begin; v < end; ++v) {
      const Point& p = vertices[v];
      if (!finite(p)) return along.store(false);
      const std::uint64_t key = curve.key(p.x, p.y);
      if (v > 0 && key <= last) {
        const Point& q = vertices[v - 1];
        if (key < last || q.x > p.x || (q.x == p.x && q.y > p.y)) return along.store(false);
      }
      if (v > begin && plan(vertices[v - 1]) != plan(p)) first = v;
      place[v] = static_cast<Index>(first);
      last = key;
    }
  });
  if (!along) place.clear();
  return place;
}

}  // namespace

Array<Index> places(const std::vector<Point>& vertices, const Context& context) {
  Array<Index> place = places_along_curve(vertices, context);
  if (!place.empty()) return place;
  const auto n = static_cast<Index>(vertices.size());
  place.resize(n);
  const Cells cells(vertices);
  std::vector<Index> start(cells.count() + 2, 0), cell(n), order;
  for (Index v = 0; v < n; ++v) {
    place[v] = v;
    cell[v] = finite(vertices[v]) ? cells.of(vertices[v]) : none;
    if (cell[v] != none) ++start[cell[v] + 2];
  }
  for (std::size_t c = 2; c < start.size(); ++c) start[c] += start[c - 1];
  order.resize(start.back());
  for (Index v = 0; v < n; ++v)
    if (cell[v] != none) order[start[cell[v] + 1]++] = v;
  const auto before = [&](Index a, Index b) {
    const Point &p = vertices[a], &q = vertices[b];
    return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : a < b;
  };
  for (Index c = 0; c < cells.count(); ++c) {
    const auto first = order.begin() + start[c], last = order.begin() + start[c + 1];
    if (last - first < 2) continue;
    std::sort(first, last, before);
    for (auto v = first + 1; v != last; ++v)
      if (plan(vertices[*v]) == plan(vertices[v[-1]])) place[*v] = place[v[-1]];
  }
  return place;
}

PlanTopology plan_topology(const Tin& tin, const Context& context) {
  return plan_topology(tin, places(tin.vertices, context), context);
}

PlanTopology plan_topology(const Tin& tin, Array<Index> places, const Context& context) {
  PlanTopology topology;
  topology.place = std::move(places);
  Chains hung = hang_half_edges(tin, topology, context);
  topology.mate = std::move(hung.next);  // a chain's links until its mates are known
  std::vector<PlanEdges> crowded(hung.ranges.size());
  hung.for_ranges(context, [&](const Chains::Range& range) {
    crowded[&range - hung.ranges.data()] = pair_range(tin, hung.first, range, topology);
  });
  topology.crowded = joined(crowded);
  const std::size_t n = tin.faces.size(), chunk = chunk_for(context, n);
  std::vector<std::vector<Index>> border(n / chunk + 1);
  parallel_for(context, n, chunk,
               [&](std::size_t begin, std::size_t end) { border[begin / chunk] = border_of(begin, end, topology); });
  topology.border = joined(border);
  return topology;
}

std::vector<BorderHalfEdge> border_edges(const Tin& tin, const PlanTopology& topology) {
  std::vector<BorderHalfEdge> edges;
  edges.reserve(topology.border.size());
  for (const Index h : topology.border)
    edges.push_back({h, topology.place[topology.from(tin, h)], topology.place[topology.to(tin, h)]});
  return edges;
}

}  // namespace terrane
