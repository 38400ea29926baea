// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/union_area.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "core/box.hpp"
#include "core/predicates.hpp"
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
  std::shared_ptr<const HeightField> field;
};

Tile tile_of(std::shared_ptr<const HeightField> field) {
  Tile tile{field->box(), {}, field};
  for (const auto& [p, q] : field->border()) tile.edges.push_back({p, q});
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
    Box box;
    Edge* edge;
    bool of_a;
  };
  std::vector<Entry> entries;
  const auto add = [&](Tile& tile, const Box& box, bool of_a) {
    for (Edge& e : tile.edges) {
      const auto [xlow, xhigh] = std::minmax(e.p.x, e.q.x);
      const auto [ylow, yhigh] = std::minmax(e.p.y, e.q.y);
      const Box own = {xlow, ylow, xhigh, yhigh};
      if (touches(own, box)) entries.push_back({own, &e, of_a});
    }
  };
  add(a, b.box, true);
  add(b, a.box, false);
  std::sort(entries.begin(), entries.end(), [](const Entry& l, const Entry& r) { return l.box.ymin < r.box.ymin; });
  std::vector<const Entry*> active[2];
  for (const Entry& entry : entries) {
    auto& others = active[entry.of_a ? 1 : 0];
    std::erase_if(others, [&](const Entry* o) { return o->box.ymax < entry.box.ymin; });
    for (const Entry* o : others) {
      if (!touches(o->box, entry.box)) continue;
      cut(*entry.edge, *o->edge, entry.of_a ? index_b : index_a);
      cut(*o->edge, *entry.edge, entry.of_a ? index_a : index_b);
    }
    active[entry.of_a ? 0 : 1].push_back(&entry);
  }
}

enum class Cover { no, yes, doubtful };

/// Whether another tile lies on the outer side of a piece of an edge, or a tile before this one shares it. Doubtful
/// where another border runs beside the piece so near that rounding decides, and not exactly along it.
Cover covered(const Edge& e, double t, double near, std::size_t self, const std::vector<Tile>& tiles) {
  const Point2 middle = e.at(t);
  for (std::size_t j = 0; j < tiles.size(); ++j) {
    if (j == self || !touches(tiles[j].box, {middle.x, middle.y, middle.x, middle.y})) continue;
    bool shared = false, taken = false;
    for (const Along& along : e.along)
      if (along.tile == j && along.t0 <= t && t <= along.t1)
        shared = true, taken = taken || !along.same_way || j < self;
    if (!shared && tiles[j].field->at(middle, near).border) return Cover::doubtful;
    if (shared ? taken : tiles[j].field->at(middle, 0).found) return Cover::yes;
  }
  return Cover::no;
}

/// The union's area by Green's theorem over its border; none where a piece is doubtful.
std::optional<double> by_border(const std::vector<Tile>& tiles, double near, Context& context) {
  double twice = 0, lost = 0;  // compensated
  const Point2 origin{tiles.front().box.xmin, tiles.front().box.ymin};
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    context.progress("union area", static_cast<double>(i) / tiles.size());
    for (const Edge& e : tiles[i].edges) {
      std::vector<double> stops = {0, 1};
      stops.insert(stops.end(), e.cuts.begin(), e.cuts.end());
      std::sort(stops.begin(), stops.end());
      const double whole = (e.p.x - origin.x) * (e.q.y - origin.y) - (e.q.x - origin.x) * (e.p.y - origin.y);
      const double length = std::hypot(e.q.x - e.p.x, e.q.y - e.p.y);
      for (std::size_t s = 0; s + 1 < stops.size(); ++s) {
        const double part = stops[s + 1] - stops[s];
        if (part == 0) continue;
        const Cover cover = covered(e, (stops[s] + stops[s + 1]) / 2, near, i, tiles);
        // The crumbs between cuts that should be one always are near another border, and weigh nothing.
        if (cover == Cover::doubtful && part * length > 8 * near) return {};
        if (cover != Cover::no) continue;
        const double y = whole * part - lost, sum = twice + y;
        lost = (sum - twice) - y;
        twice = sum;
      }
    }
  }
  return twice / 2;
}

/// The length of the union of intervals, each of one tile's crossings taken in pairs.
double length_at(double y, const std::vector<std::pair<const Edge*, std::size_t>>& active,
                  std::vector<std::pair<std::size_t, double>>& crossings,
                 std::vector<std::pair<double, double>>& spans) {
  crossings.clear(), spans.clear();
  for (const auto& [e, tile] : active)
    if ((e->p.y <= y) != (e->q.y <= y))
      crossings.emplace_back(tile, e->p.x + (e->q.x - e->p.x) * ((y - e->p.y) / (e->q.y - e->p.y)));
  std::sort(crossings.begin(), crossings.end());
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
    spans.emplace_back(crossings[i].second, crossings[i + 1].second);
  std::sort(spans.begin(), spans.end());
  double length = 0, reached = -std::numeric_limits<double>::infinity();
  for (const auto& [low, high] : spans) {
    if (high > reached) length += high - std::max(low, reached);
    reached = std::max(reached, high);
  }
  return length;
}

/// The union's area by horizontal slabs between all ends and crossings of borders, in which the union's width is
/// linear. Nothing here can be decided wrongly: the width is a continuous function of the borders, so that those an ulp
/// apart cost an ulp. But it visits an edge once per slab it spans: only for where by_border() fails. None where it
/// would take too long.
std::optional<double> by_slabs(const std::vector<Tile>& tiles, Context& context) {
  std::vector<double> stops;
  std::vector<std::pair<const Edge*, std::size_t>> edges, active;
  for (std::size_t i = 0; i < tiles.size(); ++i)
    for (const Edge& e : tiles[i].edges) {
      edges.emplace_back(&e, i);
      stops.push_back(e.p.y);
      for (double t : e.cuts) stops.push_back(e.at(t).y);
    }
  std::sort(stops.begin(), stops.end());
  stops.erase(std::unique(stops.begin(), stops.end()), stops.end());
  const auto low = [](const auto& entry) { return std::min(entry.first->p.y, entry.first->q.y); };
  std::sort(edges.begin(), edges.end(), [&](const auto& a, const auto& b) { return low(a) < low(b); });
  std::vector<std::pair<std::size_t, double>> crossings;
  std::vector<std::pair<double, double>> spans;
  constexpr std::size_t most_visits = 1'000'000'000;
  double area = 0, lost = 0;  // compensated
  for (std::size_t s = 0, next = 0, visits = 0; s + 1 < stops.size(); ++s) {
    if (s % 1024 == 0) context.progress("union area", static_cast<double>(s) / stops.size());
    std::erase_if(active, [&](const auto& entry) { return std::max(entry.first->p.y, entry.first->q.y) <= stops[s]; });
    while (next < edges.size() && low(edges[next]) <= stops[s]) active.push_back(edges[next++]);
    if ((visits += active.size()) > most_visits) return {};
    const double middle = stops[s] + (stops[s + 1] - stops[s]) / 2;
    const double y = (stops[s + 1] - stops[s]) * length_at(middle, active, crossings, spans) - lost, sum = area + y;
    lost = (sum - area) - y;
    area = sum;
  }
  return area;
}

}  // namespace

std::optional<double> union_area(const HeightFields& fields, Context& context) {
  std::vector<Tile> tiles;
  for (const auto& field : fields)
    if (!field->empty()) tiles.push_back(tile_of(field));
  if (tiles.empty()) return 0;
  double extent = 0, largest = 0;
  for (const Tile& t : tiles) {
    extent = std::max({extent, t.box.xmax - t.box.xmin, t.box.ymax - t.box.ymin});
    for (double v : {t.box.xmin, t.box.ymin, t.box.xmax, t.box.ymax}) largest = std::max(largest, std::fabs(v));
  }
  if (!std::isfinite(extent * extent)) return {};
  for (std::size_t i = 0; i < tiles.size(); ++i)
    for (std::size_t j = i + 1; j < tiles.size(); ++j)
      if (touches(tiles[i].box, tiles[j].box)) cut_each_other(tiles[i], tiles[j], i, j);

  auto area = by_border(tiles, std::max(1e-12 * extent, 1e-15 * largest), context);
  if (!area) area = by_slabs(tiles, context);
  if (!area)
    context.warn({"area-not-checked", "", "",
                  "the area of the result was not checked: the borders of the inputs nearly coincide in too many "
                  "places",
                  ""});
  return area;
}

}  // namespace terrane
