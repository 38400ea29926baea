// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/plan/noding.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "core/box.hpp"
#include "core/error.hpp"
#include "core/plan/delaunay.hpp"
#include "core/plan/exact_place.hpp"
#include "core/plan/place_order.hpp"
#include "core/predicates.hpp"
#include "core/shortest.hpp"

namespace terrane {
namespace {

Box box_of(Point2 p, Point2 q) { return around(Box{p.x, p.y, p.x, p.y}, q); }

/// Does p, on the line through a and b, lie strictly between them?
bool between(Point2 a, Point2 b, Point2 p) {
  return a.x != b.x ? std::min(a.x, b.x) < p.x && p.x < std::max(a.x, b.x)
                    : std::min(a.y, b.y) < p.y && p.y < std::max(a.y, b.y);
}

/// Cells of about one edge each, and the edges that come near them.
class Buckets {
 public:
  Buckets(std::span<const Point2> points, std::span<const NodedEdge> edges) : points_(points), edges_(edges) {
    Box box = no_box;
    for (const NodedEdge& e : edges) box = around(around(box, points[e.from]), points[e.to]);
    x_ = box.xmin, y_ = box.ymin;
    const double width = box.xmax - box.xmin, height = box.ymax - box.ymin;
    size_ = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(edges.size()))), 1, 2048);
    cell_x_ = width > 0 ? width / size_ : 1, cell_y_ = height > 0 ? height / size_ : 1;
    first_.assign(static_cast<std::size_t>(size_) * size_ + 1, 0);
    for (std::size_t e = 0; e < edges.size(); ++e) each_cell(e, [&](std::size_t cell) { ++first_[cell + 1]; });
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    listed_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t e = 0; e < edges.size(); ++e)
      each_cell(e, [&](std::size_t cell) { listed_[next[cell]++] = static_cast<Index>(e); });
  }

  std::size_t cells() const { return first_.size() - 1; }
  /// How many would be compared with how many, all told.
  std::size_t comparisons() const {
    std::size_t all = 0;
    for (std::size_t cell = 0; cell < cells(); ++cell) all += in(cell).size() * in(cell).size() / 2;
    return all;
  }
  std::span<const Index> in(std::size_t cell) const {
    return std::span(listed_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
  }

 private:
  int index(double offset, double cell) const {
    return static_cast<int>(std::clamp(std::floor(offset / cell), 0.0, size_ - 1.0));
  }

  /// Every cell that the edge passes, and those it may pass but for rounding.
  template <class Visit>
  void each_cell(std::size_t e, Visit visit) const {
    const Point2 p = points_[edges_[e].from], q = points_[edges_[e].to];
    const Point2 low = p.y <= q.y ? p : q, high = p.y <= q.y ? q : p;
    constexpr double margin = 1e-3;
    const int r0 = index(low.y - y_ - margin * cell_y_, cell_y_), r1 = index(high.y - y_ + margin * cell_y_, cell_y_);
    const double rise = high.y - low.y;
    for (int r = r0; r <= r1; ++r) {
      const auto x_at = [&](double y) { return low.x + (high.x - low.x) * std::clamp((y - low.y) / rise, 0.0, 1.0); };
      double a = low.x, b = high.x;
      if (r0 != r1 && rise > 0) a = x_at(y_ + (r - margin) * cell_y_), b = x_at(y_ + (r + 1 + margin) * cell_y_);
      if (a > b) std::swap(a, b);
      const int c0 = index(a - x_ - margin * cell_x_, cell_x_), c1 = index(b - x_ + margin * cell_x_, cell_x_);
      for (int c = c0; c <= c1; ++c) visit(static_cast<std::size_t>(r) * size_ + c);
    }
  }

  std::span<const Point2> points_;
  std::span<const NodedEdge> edges_;
  double x_ = 0, y_ = 0, cell_x_ = 1, cell_y_ = 1;
  int size_ = 1;
  std::vector<std::size_t> first_;
  std::vector<Index> listed_;
};

/// Calls visit(place) for where edges a and b, whose boxes meet, meet inside one of them.
template <class Visit>
void meetings(Point2 a0, Point2 a1, Point2 b0, Point2 b1, Visit visit) {
  if ((a0 == b0 && a1 == b1) || (a0 == b1 && a1 == b0)) return;
  const int s0 = orientation(a0, a1, b0), s1 = orientation(a0, a1, b1);
  if (s0 * s1 > 0) return;
  const int t0 = orientation(b0, b1, a0), t1 = orientation(b0, b1, a1);
  if (t0 * t1 > 0) return;
  if (s0 * s1 < 0 && t0 * t1 < 0) return visit(rounded({ExactPlace::crossing, a0, a1, b0, b1}));
  if (s0 == 0 && between(a0, a1, b0)) visit(b0);
  if (s1 == 0 && between(a0, a1, b1)) visit(b1);
  if (t0 == 0 && between(b0, b1, a0)) visit(a0);
  if (t1 == 0 && between(b0, b1, a1)) visit(a1);
}

/// More than that is no map, and would fill the memory.
constexpr std::size_t most_crossings = 10'000'000;

/// Comparisons of edges that lie close together: some ten seconds' worth. To look whether two cross costs as much as to
/// pass over many.
constexpr std::size_t most_work = 4'000'000'000, work_per_edge = 1000, work_to_look = 100;

/// Where more comparisons than that are due, edges are long and lie side by side, as those of a star do.
constexpr std::size_t many_per_edge = 100;

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorKind::limit, "too-many-crossings", "the edges " + what + "; simplify them");
}

/// Equal points become the first of them; edges without length go.
void join_equal_points(std::vector<Point2>& points, std::vector<NodedEdge>& edges) {
  std::vector<Index> order(points.size()), number(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) order[i] = static_cast<Index>(i);
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return points[a] == points[b] ? a < b : before(points[a], points[b]); });
  std::vector<Index> same(points.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    same[order[i]] = i > 0 && points[order[i]] == points[order[i - 1]] ? same[order[i - 1]] : order[i];
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (same[i] != static_cast<Index>(i)) continue;
    number[i] = static_cast<Index>(kept);
    points[kept++] = points[i];
  }
  points.resize(kept);
  for (NodedEdge& e : edges) e.from = number[same[e.from]], e.to = number[same[e.to]];
  std::erase_if(edges, [](const NodedEdge& e) { return e.from == e.to; });
}

/// Is it clear without comparing any two that no edges meet but at their ends?
bool are_apart(std::span<const Point2> points, std::span<const NodedEdge> edges) {
  std::vector<Point2> places(points.begin(), points.end());
  std::vector<NodedEdge> between(edges.begin(), edges.end());
  join_equal_points(places, between);
  std::vector<std::array<Index, 2>> ends;
  for (const NodedEdge& e : between) ends.push_back({e.from, e.to});
  return meet_at_ends_only(places, std::move(ends));
}

/// Edges by their ends; those that lie on each other are together, and first[b] is where such a bundle begins.
struct Bundles {
  explicit Bundles(const std::vector<NodedEdge>& edges) : order(edges.size()) {
    const auto ends = [&](Index e) { return std::minmax(edges[e].from, edges[e].to); };
    for (std::size_t e = 0; e < order.size(); ++e) order[e] = static_cast<Index>(e);
    std::sort(order.begin(), order.end(), [&](Index e, Index g) { return ends(e) < ends(g); });
    for (std::size_t i = 0; i < order.size(); ++i)
      if (i == 0 || ends(order[i]) != ends(order[i - 1])) {
        first.push_back(i);
        edge_each.push_back(edges[order[i]]);
      }
    first.push_back(order.size());
  }

  std::span<const Index> in(Index bundle) const {
    return std::span(order).subspan(first[bundle], first[bundle + 1] - first[bundle]);
  }

  std::vector<Index> order;
  std::vector<std::size_t> first;
  std::vector<NodedEdge> edge_each;
};

}  // namespace

std::vector<Crossing> find_crossings(std::span<const Point2> points, std::span<const NodedEdge> edges,
                                     std::size_t limit, const Context& context) {
  std::vector<Crossing> found;
  if (edges.empty()) return found;
  const Buckets buckets(points, edges);
  if (buckets.comparisons() > many_per_edge * edges.size() && are_apart(points, edges)) return found;
  const std::size_t enough = most_work + work_per_edge * edges.size();
  std::size_t work = 0;
  std::vector<std::pair<Box, Index>> near;
  for (std::size_t cell = 0; cell < buckets.cells(); ++cell) {
    near.clear();
    for (const Index e : buckets.in(cell)) near.emplace_back(box_of(points[edges[e].from], points[edges[e].to]), e);
    // From left to right: where many edges cross, their pieces crowd in few cells.
    std::sort(near.begin(), near.end(), [](auto& s, auto& t) { return s.first.xmin < t.first.xmin; });
    for (std::size_t i = 0; i < near.size(); ++i) {
      context.stop_if_cancelled();
      if (found.size() > most_crossings) refuse("cross each other more than 10 million times");
      if (work > enough) refuse("lie so close to each other that too many would have to be compared");
      for (std::size_t j = i + 1; j < near.size() && near[j].first.xmin <= near[i].first.xmax; ++j, ++work) {
        if (!touches(near[i].first, near[j].first)) continue;
        work += work_to_look;
        const auto [first, second] = std::minmax(near[i].second, near[j].second);
        const NodedEdge &a = edges[first], &b = edges[second];
        meetings(points[a.from], points[a.to], points[b.from], points[b.to], [&, f = first, g = second](Point2 at) {
          found.push_back({at, f, g});
        });
      }
    }
  }
  // A pair may share several cells.
  const auto key = [](const Crossing& c) { return std::tuple(c.a, c.b, c.at.x, c.at.y); };
  std::sort(found.begin(), found.end(), [&](auto& p, auto& q) { return key(p) < key(q); });
  found.erase(std::unique(found.begin(), found.end(), [&](auto& p, auto& q) { return key(p) == key(q); }), found.end());
  if (found.size() > limit) found.resize(limit);
  return found;
}

Noded node_edges(std::vector<Point2> points, std::vector<NodedEdge> edges, const Context& context) {
  join_equal_points(points, edges);
  Point2 last;
  for (int round = 0; round < 40; ++round) {
    const Bundles bundles(edges);
    const std::vector<Crossing> crossings =
        find_crossings(points, bundles.edge_each, static_cast<std::size_t>(-1), context);
    if (crossings.empty()) return {std::move(points), std::move(edges)};
    last = crossings.front().at;
    struct Cut {
      Index edge;
      double along;
      Point2 at;
    };
    std::vector<Cut> cuts;
    const auto cut_at = [&](Point2 at, Index bundle) {
      for (const Index e : bundles.in(bundle)) {
        const Point2 p = points[edges[e].from], q = points[edges[e].to];
        if (at == p || at == q) return;
        const double dx = q.x - p.x, dy = q.y - p.y;
        cuts.push_back({e, std::fabs(dx) >= std::fabs(dy) ? (at.x - p.x) / dx : (at.y - p.y) / dy, at});
        if (cuts.size() > 2 * most_crossings) refuse("cross each other more than 10 million times");
      }
    };
    for (const Crossing& c : crossings) cut_at(c.at, c.a), cut_at(c.at, c.b);
    std::sort(cuts.begin(), cuts.end(), [](const Cut& s, const Cut& t) {
      return std::tie(s.edge, s.along, s.at.x, s.at.y) < std::tie(t.edge, t.along, t.at.x, t.at.y);
    });
    std::vector<NodedEdge> pieces;
    std::size_t cut = 0;
    for (Index e = 0; e < static_cast<Index>(edges.size()); ++e) {
      NodedEdge rest = edges[e];
      for (; cut < cuts.size() && cuts[cut].edge == e; ++cut) {
        const auto at = static_cast<Index>(points.size());
        points.push_back(cuts[cut].at);
        pieces.push_back({rest.from, at, rest.owner});
        rest.from = at;
      }
      pieces.push_back(rest);
    }
    edges = std::move(pieces);
    join_equal_points(points, edges);
  }
  throw Error(
      ErrorKind::input, "rounding",
      "near " + shortest(last.x) + ", " + shortest(last.y) +
          " edges cross so near to each other that doubles cannot tell the crossings apart; simplify them there");
}

}  // namespace terrane
