// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/topology.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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

Turn turn_of(const Tin& tin, const std::vector<Index>& place, const Face& face) {
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

/// The half-edges, sorted into a bucket per lower end by counting.
struct Spokes {
  std::vector<Index> start;
  std::vector<Spoke> all;
};

Spokes gather_spokes(const Tin& tin, const PlanTopology& topology) {
  Spokes spokes;
  spokes.start.assign(tin.vertices.size() + 2, 0);
  const auto each = [&](auto&& use) {
    for (Index f = 0; f < static_cast<Index>(tin.faces.size()); ++f) {
      if (!topology.in_plan(f)) continue;
      const Face& face = tin.faces[f];
      const Face at = {topology.place[face[0]], topology.place[face[1]], topology.place[face[2]]};
      const bool turned = topology.turn[f] == Turn::right;
      for (Index k = 0; k < 3; ++k) {
        const Index a = at[k], b = at[k == 2 ? 0 : k + 1];
        const bool outward = (a < b) != turned;
        use(std::min(a, b), Spoke{std::max(a, b), outward ? 3 * f + k : ~(3 * f + k)});
      }
    }
  };
  each([&](Index low, const Spoke&) { ++spokes.start[low + 2]; });
  for (std::size_t v = 2; v < spokes.start.size(); ++v) spokes.start[v] += spokes.start[v - 1];
  spokes.all.resize(spokes.start.back());
  each([&](Index low, const Spoke& spoke) { spokes.all[spokes.start[low + 1]++] = spoke; });
  return spokes;
}

}  // namespace

std::vector<Index> places(const std::vector<Point>& vertices) {
  const auto n = static_cast<Index>(vertices.size());
  std::vector<Index> place(n);
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

PlanTopology plan_topology(const Tin& tin, std::vector<Index> places) {
  PlanTopology topology;
  topology.place = std::move(places);
  topology.turn.reserve(tin.faces.size());
  for (const Face& face : tin.faces) topology.turn.push_back(turn_of(tin, topology.place, face));
  topology.mate.assign(3 * tin.faces.size(), no_mate);
  Spokes spokes = gather_spokes(tin, topology);
  const auto before = [](const Spoke& a, const Spoke& b) {
    return a.other != b.other ? a.other < b.other : a.half_edge() < b.half_edge();
  };
  for (std::size_t v = 0; v < tin.vertices.size(); ++v) {
    Spoke *first = spokes.all.data() + spokes.start[v], *last = spokes.all.data() + spokes.start[v + 1];
    std::sort(first, last, before);
    while (first != last) {
      Spoke* end = first + 1;
      while (end != last && end->other == first->other) ++end;
      pair_up(first, end, static_cast<Index>(v), topology);
      first = end;
    }
  }
  for (Index h = 0; h < static_cast<Index>(topology.mate.size()); ++h) {
    if (!topology.in_plan(h / 3)) topology.mate[h] = no_half_edge;
    if (topology.mate[h] == no_mate) topology.border.push_back(h);
  }
  return topology;
}

}  // namespace terrane
