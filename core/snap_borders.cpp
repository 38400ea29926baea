// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/snap_borders.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>

#include "core/box.hpp"
#include "core/merge.hpp"
#include "core/mosaic.hpp"
#include "core/predicates.hpp"
#include "core/rounding.hpp"
#include "core/segment_index.hpp"
#include "core/validate.hpp"

namespace terrane {
namespace {

bool before(Point2 p, Point2 q) { return std::tie(p.x, p.y) < std::tie(q.x, q.y); }

bool proper_crossing(Point2 a, Point2 b, Point2 c, Point2 d) {
  const int abc = orientation(a, b, c), abd = orientation(a, b, d);
  if (abc * abd > 0) return false;
  const int cda = orientation(c, d, a), cdb = orientation(c, d, b);
  if (cda * cdb > 0) return false;
  if (abc != 0 || abd != 0) return true;
  // On one line: do they share more than nothing?
  const auto low = [](Point2 p, Point2 q) { return before(p, q) ? p : q; };
  const auto high = [](Point2 p, Point2 q) { return before(p, q) ? q : p; };
  return !before(high(a, b), low(c, d)) && !before(high(c, d), low(a, b));
}

/// Whether a vertex may still be moved: free ones only. Targets stay where they are because others went there.
enum class State : std::uint8_t { free, moved, target };

/// One tile while its border is moved and refined.
class Moving {
 public:
  struct Edge {
    Index from, to;  // the tile on the left
  };

  explicit Moving(const Tin& tin) : piece_(piece_of(tin, 0)) {
    PlanarMesh mesh{piece_.surface.points, piece_.surface.faces, {}, {}};
    connect(mesh);
    on_border_.assign(points().size(), 0);
    for (Index f = 0; f < static_cast<Index>(mesh.faces.size()); ++f)
      for (int k = 0; k < 3; ++k) {
        if (mesh.neighbours[f][k] != none) continue;
        const Index p = mesh.faces[f][(k + 1) % 3], q = mesh.faces[f][(k + 2) % 3];
        edges.push_back({p, q});
        chains.push_back({p, q});
        face_at_[key(p, q)] = f;
        for (const Index v : {p, q}) {
          if (!on_border_[v]) border.push_back(v);
          on_border_[v] = 1;
          next_[v].push_back(v == p ? q : p);
        }
      }
    std::sort(border.begin(), border.end(), [&](Index p, Index q) { return before(points()[p], points()[q]); });
    for (Index f = 0; f < static_cast<Index>(mesh.faces.size()); ++f)
      for (const Index v : mesh.faces[f])
        if (on_border_[v]) stars_[v].push_back(f);
    original.assign(points().begin(), points().end());
    state.assign(points().size(), State::free);
    for (const Index v : border) occupied_.emplace(std::pair(points()[v].x, points()[v].y), v);
  }

  const Array<Point2>& points() const { return piece_.surface.points; }
  Point2 at(Index v) const { return points()[v]; }

  /// Whether a vertex of the border stands there.
  bool stands_at(Point2 p) const { return occupied_.contains({p.x, p.y}); }

  bool can_move(Index v, Point2 to, const std::vector<Index>& own_edges) const {
    if (stands_at(to)) return false;
    for (const Index f : stars_.at(v)) {
      Point2 c[3];
      for (int k = 0; k < 3; ++k) c[k] = face(f)[k] == v ? to : at(face(f)[k]);
      if (orientation(c[0], c[1], c[2]) <= 0) return false;
    }
    for (const Index w : next_.at(v))
      if (crosses_border(to, at(w), v, w, own_edges)) return false;
    return true;
  }

  void move(Index v, Point2 to) {
    occupied_.erase({at(v).x, at(v).y});
    piece_.surface.points[v] = to;
    occupied_.emplace(std::pair(to.x, to.y), v);
    changed = true;
  }

  /// The part of a border edge, refined as it may be, that passes nearest to a place.
  struct Nearest {
    Index from = none, to = none;
    std::size_t part = 0;
    double t = 0, distance = 0;
  };
  std::optional<Nearest> nearest(Index edge, Point2 p, const PlanMetric& metric) const {
    std::optional<Nearest> best;
    const std::vector<Index>& chain = chains[edge];
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
      const Point2 a = at(chain[i]), b = at(chain[i + 1]);
      const double t = nearest_fraction(a, b, p, metric);
      const double d = metric.distance(p, point_along(a, b, t));
      if (!best || d < best->distance) best = Nearest{chain[i], chain[i + 1], i, t, d};
    }
    return best;
  }

  bool can_insert(const Nearest& where, Point2 p, const std::vector<Index>& own_edges) const {
    if (stands_at(p)) return false;
    const Index f = face_at_.at(key(where.from, where.to));
    const Point2 a = at(where.from), b = at(where.to), c = at(opposite(f, where.from, where.to));
    if (orientation(a, p, c) <= 0 || orientation(p, b, c) <= 0) return false;
    return !crosses_border(a, p, where.from, where.to, own_edges) &&
           !crosses_border(p, b, where.from, where.to, own_edges);
  }

  void insert(Index edge, const Nearest& where, Point2 p) {
    CornerSurface& surface = piece_.surface;
    const Index f = face_at_.at(key(where.from, where.to)), c = opposite(f, where.from, where.to);
    const Index made = static_cast<Index>(surface.points.size()), g = static_cast<Index>(surface.faces.size());
    surface.points.push_back(p);
    const auto z = [&](Index v) { return surface.z[3 * static_cast<std::size_t>(f) + corner(f, v)]; };
    const auto firm = [&](Index v) { return surface.firm[3 * static_cast<std::size_t>(f) + corner(f, v)]; };
    const double za = z(where.from), zb = z(where.to), zc = z(c);
    const double zp = where.t <= 0.5 ? za + where.t * (zb - za) : zb + (1 - where.t) * (za - zb);
    const std::uint8_t firm_a = firm(where.from), firm_b = firm(where.to), firm_c = firm(c);
    surface.faces[f] = {where.from, made, c};
    surface.faces.push_back({made, where.to, c});
    for (const double value : {zp, zb, zc}) surface.z.push_back(value);
    for (const std::uint8_t value : {std::uint8_t{0}, firm_b, firm_c}) surface.firm.push_back(value);
    const double own[3] = {za, zp, zc};
    const std::uint8_t own_firm[3] = {firm_a, 0, firm_c};
    for (int k = 0; k < 3; ++k) {
      surface.z[3 * static_cast<std::size_t>(f) + k] = own[k];
      surface.firm[3 * static_cast<std::size_t>(f) + k] = own_firm[k];
    }
    piece_.contributors.push_back(0);
    face_at_.erase(key(where.from, where.to));
    face_at_[key(where.from, made)] = f;
    face_at_[key(made, where.to)] = g;
    if (const auto it = face_at_.find(key(where.to, c)); it != face_at_.end() && it->second == f) it->second = g;
    stars_[made] = {f, g};
    std::erase(stars_[where.to], f);
    stars_[where.to].push_back(g);
    if (on_border_[c]) stars_[c].push_back(g);
    std::replace(next_[where.from].begin(), next_[where.from].end(), where.to, made);
    std::replace(next_[where.to].begin(), next_[where.to].end(), where.from, made);
    next_[made] = {where.from, where.to};
    on_border_.push_back(1);
    original.push_back(p);
    state.push_back(State::target);
    occupied_.emplace(std::pair(p.x, p.y), made);
    chains[edge].insert(chains[edge].begin() + static_cast<std::ptrdiff_t>(where.part) + 1, made);
    changed = true;
  }

  /// Of the border edges that a move or a new vertex makes.
  Box box_of_border_at(Index v, Point2 to) const {
    Box box = around(no_box, to);
    for (const Index w : next_.at(v)) box = around(box, at(w));
    return box;
  }
  Box box_of(const Nearest& where, Point2 p) const {
    return around(around(around(no_box, p), at(where.from)), at(where.to));
  }

  Tin tin() const { return canonical(as_tin(piece_)); }

  std::vector<Edge> edges;                 // of the border as it came
  std::vector<std::vector<Index>> chains;  // the vertices along each edge now
  std::vector<Index> border;               // vertices of the border as it came, by place
  std::vector<Point2> original;
  std::vector<State> state;
  bool changed = false;

 private:
  static std::uint64_t key(Index p, Index q) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(p)) << 32 | static_cast<std::uint32_t>(q);
  }
  const Face& face(Index f) const { return piece_.surface.faces[f]; }
  int corner(Index f, Index v) const { return face(f)[0] == v ? 0 : face(f)[1] == v ? 1 : 2; }
  Index opposite(Index f, Index p, Index q) const {
    for (const Index v : face(f))
      if (v != p && v != q) return v;
    return none;
  }

  /// Would a segment of the border cross or touch the rest of it, but where it begins and ends? `v` and `w` are the
  /// vertices whose edges it replaces.
  bool crosses_border(Point2 p, Point2 q, Index v, Index w, const std::vector<Index>& own_edges) const {
    for (const Index e : own_edges)
      for (std::size_t i = 0; i + 1 < chains[e].size(); ++i) {
        const Index a = chains[e][i], b = chains[e][i + 1];
        if (a == v || b == v || a == w || b == w) continue;
        if (proper_crossing(p, q, at(a), at(b))) return true;
      }
    return false;
  }

  Piece piece_;
  std::vector<std::uint8_t> on_border_;
  std::unordered_map<std::uint64_t, Index> face_at_;     // border half-edge -> its face
  std::unordered_map<Index, std::vector<Index>> stars_;  // faces around a border vertex
  std::unordered_map<Index, std::vector<Index>> next_;   // its neighbours along the border
  std::map<std::pair<double, double>, Index> occupied_;
};

class Snapper {
 public:
  Snapper(const std::vector<Tin>& tiles, double distance, const PlanMetric& metric)
      : tiles_(tiles), distance_(distance), metric_(metric) {
    for (const int t : order_by_content(tiles))
      if (!tiles[t].faces.empty()) order_.push_back(t);
    for (const int t : order_) moving_.emplace_back(tiles[t]);
    std::vector<std::array<Point2, 2>> segments;
    double widest = 0;
    for (std::size_t r = 0; r < moving_.size(); ++r)
      for (std::size_t e = 0; e < moving_[r].edges.size(); ++e) {
        const auto& [p, q] = moving_[r].edges[e];
        segments.push_back({moving_[r].at(p), moving_[r].at(q)});
        owner_.push_back({static_cast<int>(r), static_cast<Index>(e)});
        const Box reach = metric.around(moving_[r].at(p), distance);
        widest = std::max({widest, reach.xmax - reach.xmin, reach.ymax - reach.ymin});
      }
    index_.emplace(std::move(segments), 2 * widest);
  }

  SnappedTiles run(Context& context) {
    context.progress("snap", 0);
    vertices_to_vertices();
    context.progress("snap", 0.4);
    to_edges(true);
    to_edges(false);
    context.progress("snap", 0.8);
    SnappedTiles result{tiles_, {}};
    for (std::size_t r = 0; r < moving_.size(); ++r) take(r, result);
    const SnapReport& counted = result.report;
    if (counted.moved > 0) result.report.mean_move = sum_ / static_cast<double>(counted.moved);
    context.progress("snap", 1);
    return result;
  }

 private:
  struct Owner {
    int rank;
    Index edge;
  };
  struct Candidate {
    int rank;
    double distance;
    Point2 from, to;
    Index vertex;
    int target_rank;
    Index target;
  };

  /// Vertices at one place are mates as they are; of the others the nearest pairs come first.
  void vertices_to_vertices() {
    std::vector<Candidate> candidates;
    std::vector<Index> near;
    for (int r = 0; r < static_cast<int>(moving_.size()); ++r)
      for (const Index v : moving_[r].border) {
        const Point2 p = moving_[r].at(v);
        index_->near(metric_.around(p, distance_), near);
        for (const Index i : near) {
          const auto [rank, e] = owner_[i];
          if (rank >= r) continue;
          const Index u = moving_[rank].edges[e].from;  // each border vertex begins an edge
          const Index w = moving_[rank].edges[e].to;
          for (const Index target : {u, w}) {
            const Point2 q = moving_[rank].at(target);
            const double d = metric_.distance(p, q);
            if (d <= distance_) candidates.push_back({r, d, p, q, v, rank, target});
          }
        }
      }
    const auto key = [](const Candidate& c) {
      return std::tuple(c.rank, c.distance, c.from.x, c.from.y, c.to.x, c.to.y, c.target_rank);
    };
    std::sort(candidates.begin(), candidates.end(), [&](auto& a, auto& b) { return key(a) < key(b); });
    for (const Candidate& c : candidates)
      if (c.from == c.to) {
        moving_[c.rank].state[c.vertex] = State::target;
        moving_[c.target_rank].state[c.target] = State::target;
      }
    for (const Candidate& c : candidates) {
      if (moving_[c.rank].state[c.vertex] != State::free) continue;
      if (moving_[c.target_rank].state[c.target] == State::moved) continue;
      if (!try_move(c.rank, c.vertex, c.to)) continue;
      moving_[c.target_rank].state[c.target] = State::target;
    }
  }

  bool try_move(int rank, Index v, Point2 to) {
    Moving& tile = moving_[rank];
    if (!tile.can_move(v, to, own_edges(rank, tile.box_of_border_at(v, to)))) {
      skipped_.emplace(rank, v);
      return false;
    }
    tile.move(v, to);
    tile.state[v] = State::moved;
    return true;
  }

  /// Edges of a tile's own border that new ones within a box may cross, wherever they are by now.
  const std::vector<Index>& own_edges(int rank, Box box) {
    for (const Point2 p : {Point2{box.xmin, box.ymin}, Point2{box.xmax, box.ymax}})
      box = around(box, metric_.around(p, 2 * distance_));
    index_->near(box, near_own_);
    own_.clear();
    for (const Index i : near_own_)
      if (owner_[i].rank == rank) own_.push_back(owner_[i].edge);
    return own_;
  }

  /// Vertices onto edges: those that are free move onto edges that have not; any others have the edge led through them.
  void to_edges(bool free_ones) {
    std::vector<Index> near;
    for (int r = 0; r < static_cast<int>(moving_.size()); ++r)
      for (const Index v : moving_[r].border) {
        const bool is_free = moving_[r].state[v] == State::free;
        if (is_free != free_ones && free_ones) continue;
        const Point2 p = moving_[r].at(v);
        index_->near(metric_.around(p, 2 * distance_), near);
        if (free_ones)
          onto_nearest_edge(r, v, p, near);
        else
          lead_edges_through(r, v, p, near);
      }
  }

  bool lies_where_it_lay(int rank, Index edge) const {
    const Moving& tile = moving_[rank];
    return tile.state[tile.edges[edge].from] != State::moved && tile.state[tile.edges[edge].to] != State::moved;
  }

  struct Way {
    double distance;
    Point2 foot;
    int rank;
    Index edge;
    Moving::Nearest where;
  };

  void onto_nearest_edge(int r, Index v, Point2 p, const std::vector<Index>& near) {
    std::optional<Way> best;
    for (const Index i : near) {
      const auto [rank, e] = owner_[i];
      if (rank == r || !lies_where_it_lay(rank, e)) continue;
      const auto where = moving_[rank].nearest(e, p, metric_);
      if (!where || where->distance > distance_ || where->t <= 0 || where->t >= 1) continue;
      const Point2 foot = point_along(moving_[rank].at(where->from), moving_[rank].at(where->to), where->t);
      const Way way{where->distance, foot, rank, e, *where};
      const auto key = [](const Way& w) { return std::tuple(w.distance, w.foot.x, w.foot.y, w.rank); };
      if (!best || key(way) < key(*best)) best = way;
    }
    if (!best) return;
    Moving& other = moving_[best->rank];
    if (best->foot == p || orientation(other.at(best->where.from), other.at(best->where.to), p) == 0) {
      fix(r, v, best->rank, best->edge);
      return;
    }
    if (!other.can_insert(best->where, best->foot, own_edges(best->rank, other.box_of(best->where, best->foot)))) {
      skipped_.emplace(r, v);
      return;
    }
    if (!try_move(r, v, best->foot)) return;
    other.insert(best->edge, best->where, best->foot);
    for (const Index end : {other.edges[best->edge].from, other.edges[best->edge].to})
      if (other.state[end] == State::free) other.state[end] = State::target;
  }

  void fix(int r, Index v, int rank, Index edge) {
    moving_[r].state[v] = State::target;
    Moving& other = moving_[rank];
    for (const Index end : {other.edges[edge].from, other.edges[edge].to})
      if (other.state[end] == State::free) other.state[end] = State::target;
  }

  void lead_edges_through(int r, Index v, Point2 p, const std::vector<Index>& near) {
    // The nearest edge of each other tile that has no vertex there yet.
    std::map<int, Way> ways;
    for (const Index i : near) {
      const auto [rank, e] = owner_[i];
      if (rank == r || moving_[rank].stands_at(p)) continue;
      const auto where = moving_[rank].nearest(e, p, metric_);
      if (!where || where->distance > distance_ || where->t <= 0 || where->t >= 1) continue;
      const Way way{where->distance, moving_[rank].at(where->from), rank, e, *where};
      const auto [it, fresh] = ways.try_emplace(rank, way);
      const auto key = [](const Way& w) { return std::tuple(w.distance, w.foot.x, w.foot.y); };
      if (!fresh && key(way) < key(it->second)) it->second = way;
    }
    for (const auto& [rank, way] : ways) {
      Moving& other = moving_[rank];
      if (orientation(other.at(way.where.from), other.at(way.where.to), p) == 0) continue;  // conforming as it is
      if (!other.can_insert(way.where, p, own_edges(rank, other.box_of(way.where, p)))) {
        skipped_.emplace(r, v);
        continue;
      }
      other.insert(way.edge, way.where, p);
    }
  }

  /// A tile that verifies is taken, else it stays as it came.
  void take(std::size_t r, SnappedTiles& result) {
    const Moving& tile = moving_[r];
    SnapReport& report = result.report;
    std::size_t skipped = 0;
    for (const auto& [rank, v] : skipped_) skipped += rank == static_cast<int>(r) && tile.state[v] != State::moved;
    std::size_t moved = 0;
    double sum = 0, largest = 0;
    for (const Index v : tile.border)
      if (tile.state[v] == State::moved) {
        const double d = metric_.distance(tile.original[v], tile.at(v));
        ++moved;
        sum += d;
        largest = std::max(largest, d);
      }
    if (tile.changed) {
      Tin tin = tile.tin();
      const Inspection seen = inspect(tin);
      if (seen.inverted + seen.degenerate + seen.t_junctions + seen.non_manifold_edges + seen.overlaps > 0) {
        report.skipped += skipped + moved;
        return;
      }
      result.tiles[order_[r]] = std::move(tin);
    }
    report.skipped += skipped;
    report.moved += moved;
    report.inserted += tile.points().size() - first_size(r);
    report.max_move = std::max(report.max_move, largest);
    sum_ += sum;
  }

  std::size_t first_size(std::size_t r) const {
    std::size_t chained = 0;
    for (const auto& chain : moving_[r].chains) chained += chain.size() - 2;
    return moving_[r].points().size() - chained;
  }

  const std::vector<Tin>& tiles_;
  double distance_;
  const PlanMetric& metric_;
  std::vector<int> order_;  // rank -> tile
  std::vector<Moving> moving_;
  std::vector<Owner> owner_;  // of each segment of the index
  std::optional<SegmentIndex> index_;
  std::set<std::pair<int, Index>> skipped_;
  std::vector<Index> near_own_, own_;
  double sum_ = 0;
};

}  // namespace

SnappedTiles snap_borders(const std::vector<Tin>& tiles, double distance, const PlanMetric& metric, Context& context) {
  if (!(distance > 0)) return {tiles, {}};
  return Snapper(tiles, distance, metric).run(context);
}

}  // namespace terrane
