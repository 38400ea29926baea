// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/union_area.hpp"

#include <algorithm>
#include <memory>

#include "core/predicates.hpp"
#include "core/topology.hpp"
#include "ops/heights.hpp"

namespace terrane {
namespace {

struct Along {  // another tile's border runs along this edge from t0 to t1
  double t0, t1;
  std::size_t tile;
  bool same_way;
};

struct Edge {
  Point2 p, q;  // the domain on the left
  std::vector<double> cuts = {};
  std::vector<Along> along = {};

  Point2 at(double t) const { return {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)}; }
  double parameter(Point2 r) const {
    const double ux = q.x - p.x, uy = q.y - p.y;
    return ((r.x - p.x) * ux + (r.y - p.y) * uy) / (ux * ux + uy * uy);
  }
};

struct Tile {
  Box box;
  std::vector<Edge> edges;
  std::unique_ptr<HeightField> field;
};

bool apart(const Box& a, const Box& b) {
  return a.xmax < b.xmin || b.xmax < a.xmin || a.ymax < b.ymin || b.ymax < a.ymin;
}

Tile tile_of(const Tin& tin) {
  Tile tile{bounds(tin), {}, std::make_unique<HeightField>(tin)};
  const PlanTopology topology = plan_topology(tin);
  for (Index h : topology.border)
    tile.edges.push_back({plan(tin.vertices[topology.from(tin, h)]), plan(tin.vertices[topology.to(tin, h)])});
  return tile;
}

/// Notes on `e` where `other`, of that tile, crosses it, ends on it or runs along it. Decided exactly.
void cut(Edge& e, const Edge& other, std::size_t tile) {
  const int from = orientation(e.p, e.q, other.p), to = orientation(e.p, e.q, other.q);
  if (from == 0 && to == 0) {
    const double a = e.parameter(other.p), b = e.parameter(other.q);
    const double t0 = std::clamp(std::min(a, b), 0.0, 1.0), t1 = std::clamp(std::max(a, b), 0.0, 1.0);
    if (t0 >= t1) return;
    e.cuts.insert(e.cuts.end(), {t0, t1});
    e.along.push_back({t0, t1, tile, a < b});
    return;
  }
  if (from * to > 0) return;
  if (orientation(other.p, other.q, e.p) * orientation(other.p, other.q, e.q) > 0) return;
  const double a = area2_accurate(other.p, other.q, e.p), b = area2_accurate(other.p, other.q, e.q);
  if (a != b) e.cuts.push_back(std::clamp(a / (a - b), 0.0, 1.0));
}

/// Every pair of edges of two tiles whose boxes meet, by a sweep upwards.
void cut_each_other(Tile& a, Tile& b, std::size_t index_a, std::size_t index_b) {
  struct Entry {
    double ymin, ymax;
    Edge* edge;
    bool of_a;
  };
  std::vector<Entry> entries;
  const auto add = [&](Tile& tile, const Box& box, bool of_a) {
    for (Edge& e : tile.edges) {
      const auto [xlow, xhigh] = std::minmax(e.p.x, e.q.x);
      const auto [ylow, yhigh] = std::minmax(e.p.y, e.q.y);
      if (!apart({xlow, ylow, xhigh, yhigh}, box)) entries.push_back({ylow, yhigh, &e, of_a});
    }
  };
  add(a, b.box, true);
  add(b, a.box, false);
  std::sort(entries.begin(), entries.end(), [](const Entry& l, const Entry& r) { return l.ymin < r.ymin; });
  std::vector<const Entry*> active[2];
  for (const Entry& entry : entries) {
    auto& others = active[entry.of_a ? 1 : 0];
    std::erase_if(others, [&](const Entry* o) { return o->ymax < entry.ymin; });
    for (const Entry* o : others) {
      cut(*entry.edge, *o->edge, entry.of_a ? index_b : index_a);
      cut(*o->edge, *entry.edge, entry.of_a ? index_a : index_b);
    }
    active[entry.of_a ? 0 : 1].push_back(&entry);
  }
}

/// Whether another tile lies on the outer side of a piece of an edge, or a tile before this one shares it.
bool covered(const Edge& e, double t, std::size_t self, const std::vector<Tile>& tiles) {
  const Point2 middle = e.at(t);
  for (std::size_t j = 0; j < tiles.size(); ++j) {
    if (j == self || apart(tiles[j].box, {middle.x, middle.y, middle.x, middle.y})) continue;
    bool shared = false, taken = false;
    for (const Along& along : e.along)
      if (along.tile == j && along.t0 <= t && t <= along.t1)
        shared = true, taken = taken || !along.same_way || j < self;
    if (shared ? taken : tiles[j].field->at(middle, 0).found) return true;
  }
  return false;
}

}  // namespace

double union_area(const std::vector<const Tin*>& tins, Context& context) {
  std::vector<Tile> tiles;
  for (const Tin* tin : tins)
    if (!tin->faces.empty()) tiles.push_back(tile_of(*tin));
  for (std::size_t i = 0; i < tiles.size(); ++i)
    for (std::size_t j = i + 1; j < tiles.size(); ++j)
      if (!apart(tiles[i].box, tiles[j].box)) cut_each_other(tiles[i], tiles[j], i, j);

  double twice = 0, lost = 0;  // compensated
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    context.progress("union area", static_cast<double>(i) / tiles.size());
    const Point2 origin{tiles.front().box.xmin, tiles.front().box.ymin};
    for (Edge& e : tiles[i].edges) {
      std::vector<double> stops = {0, 1};
      stops.insert(stops.end(), e.cuts.begin(), e.cuts.end());
      std::sort(stops.begin(), stops.end());
      const double whole = (e.p.x - origin.x) * (e.q.y - origin.y) - (e.q.x - origin.x) * (e.p.y - origin.y);
      for (std::size_t s = 0; s + 1 < stops.size(); ++s) {
        if (stops[s] == stops[s + 1] || covered(e, (stops[s] + stops[s + 1]) / 2, i, tiles)) continue;
        const double y = whole * (stops[s + 1] - stops[s]) - lost, sum = twice + y;
        lost = (sum - twice) - y;
        twice = sum;
      }
    }
  }
  return twice / 2;
}

}  // namespace terrane
