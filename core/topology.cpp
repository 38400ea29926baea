// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/topology.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/hilbert.hpp"
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

/// A half-edge as its lower end sees it.
struct Spoke {
  Index other;  // the higher end
  Index code;   // the half-edge when it runs towards the higher end, its complement when it comes from there
  bool outward() const { return code >= 0; }
  Index half_edge() const { return code >= 0 ? code : ~code; }
};

/// Pairs the half-edges of one plan edge: all of them run between the same two places.
void pair_up(Spoke* first, Spoke* last, Index low, PlanTopology& topology) {
  const auto count = last - first;
  if (count == 2 && first->outward() != first[1].outward()) {
    topology.mate[first->half_edge()] = first[1].half_edge();
    topology.mate[first[1].half_edge()] = first->half_edge();
    return;
  }
  if (count == 1) return;
  Spoke* inward = std::stable_partition(first, last, [](const Spoke& s) { return s.outward(); });
  topology.crowded.push_back({low, first->other});
  for (Spoke *out = first, *in = inward; out != inward && in != last; ++out, ++in) {
    topology.mate[out->half_edge()] = in->half_edge();
    topology.mate[in->half_edge()] = out->half_edge();
  }
}

/// Judges the faces and hangs their half-edges in a chain at the lower end of each, in order, linked through `mate`
/// until the mate is known. Returns the first of each chain.
Array<Index> hang_half_edges(const Tin& tin, PlanTopology& topology) {
  Array<Index> first(tin.vertices.size(), none);
  topology.turn.resize(tin.faces.size());
  topology.mate.resize(3 * tin.faces.size());
  for (auto f = static_cast<Index>(tin.faces.size()); f-- > 0;) {
    const Face& face = tin.faces[f];
    topology.turn[f] = turn_of(tin, topology.place, face);
    if (!topology.in_plan(f)) {
      for (Index k = 0; k < 3; ++k) topology.mate[3 * f + k] = no_half_edge;
      continue;
    }
    const Face at = {topology.place[face[0]], topology.place[face[1]], topology.place[face[2]]};
    for (Index k = 3; k-- > 0;) {
      Index& head = first[std::min(at[k], at[k == 2 ? 0 : k + 1])];
      topology.mate[3 * f + k] = std::exchange(head, 3 * f + k);
    }
  }
  return first;
}

/// Takes the chain at a vertex apart: its half-edges by their other end, each as yet without a mate.
void take_spokes(const Tin& tin, Index low, Index chain, PlanTopology& topology, std::vector<Spoke>& spokes) {
  spokes.clear();
  while (chain != none) {
    const Index h = chain, f = h / 3, k = h - 3 * f;
    chain = std::exchange(topology.mate[h], no_mate);
    const Index a = topology.place[tin.faces[f][k]], b = topology.place[tin.faces[f][k == 2 ? 0 : k + 1]];
    const bool outward = (a == low) != (topology.turn[f] == Turn::right);
    spokes.push_back({a == low ? b : a, outward ? h : ~h});
  }
  const auto before = [](const Spoke& a, const Spoke& b) {
    return a.other != b.other ? a.other < b.other : a.half_edge() < b.half_edge();
  };
  std::sort(spokes.begin(), spokes.end(), before);
}

/// The same as places() below, where it needs no sorting: vertices stand along the Hilbert curve, so that equal places
/// are neighbours. Empty when they do not, or some are not finite.
Array<Index> places_along_curve(const std::vector<Point>& vertices) {
  Box box{INFINITY, INFINITY, -INFINITY, -INFINITY};
  for (const Point& p : vertices) {
    if (!finite(p)) return {};
    box = {std::min(box.xmin, p.x), std::min(box.ymin, p.y), std::max(box.xmax, p.x), std::max(box.ymax, p.y)};
  }
  const HilbertCurve curve(box);
  const auto n = static_cast<Index>(vertices.size());
  Array<Index> place(n);
  std::uint64_t last = 0;
  for (Index v = 0; v < n; ++v) {
    const Point& p = vertices[v];
    const std::uint64_t key = curve.key(p.x, p.y);
    place[v] = v;
    if (v > 0 && key <= last) {
      const Point& q = vertices[v - 1];
      if (key < last || q.x > p.x || (q.x == p.x && q.y > p.y)) return {};
      if (plan(q) == plan(p)) place[v] = place[v - 1];
    }
    last = key;
  }
  return place;
}

}  // namespace

Array<Index> places(const std::vector<Point>& vertices) {
  Array<Index> place = places_along_curve(vertices);
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

PlanTopology plan_topology(const Tin& tin) { return plan_topology(tin, places(tin.vertices)); }

PlanTopology plan_topology(const Tin& tin, Array<Index> places) {
  PlanTopology topology;
  topology.place = std::move(places);
  const Array<Index> first = hang_half_edges(tin, topology);
  std::vector<Spoke> spokes;
  for (Index v = 0; v < static_cast<Index>(first.size()); ++v) {
    if (first[v] == none) continue;
    take_spokes(tin, v, first[v], topology, spokes);
    for (Spoke *spoke = spokes.data(), *last = spoke + spokes.size(); spoke != last;) {
      Spoke* end = spoke + 1;
      while (end != last && end->other == spoke->other) ++end;
      pair_up(spoke, end, v, topology);
      spoke = end;
    }
  }
  for (Index h = 0; h < static_cast<Index>(topology.mate.size()); ++h)
    if (topology.mate[h] == no_mate) topology.border.push_back(h);
  return topology;
}

}  // namespace terrane
