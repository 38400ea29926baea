// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/snap_borders.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "core/box.hpp"
#include "core/merge.hpp"
#include "core/merge/border_editor.hpp"
#include "core/plan/segment_index.hpp"
#include "core/predicates.hpp"
#include "core/validate.hpp"

namespace terrane {
namespace {

/// Whether a vertex may still be moved: free ones only. Targets stay where they are because others went there.
enum class State : std::uint8_t { free, moved, target };

/// One tile while it is snapped.
struct Moving {
  explicit Moving(const Tin& tin) : editor(piece_of(tin, 0)) {
    original.assign(editor.piece().surface.points.begin(), editor.piece().surface.points.end());
    state.assign(original.size(), State::free);
  }
  bool lies_where_it_lay(Index edge) const {
    const auto& [from, to, face] = editor.edges()[edge];
    return state[from] != State::moved && state[to] != State::moved;
  }
  /// What lies on an edge relies on it from now on.
  void hold(Index edge) {
    for (const Index end : {editor.edges()[edge].from, editor.edges()[edge].to})
      if (state[end] == State::free) state[end] = State::target;
  }

  BorderEditor editor;
  std::vector<Point2> original;  // places, by vertex; vertices made since have none
  std::vector<State> state;
  bool changed = false;
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
    for (std::size_t r = 0; r < moving_.size(); ++r) {
      const BorderEditor& editor = moving_[r].editor;
      for (std::size_t e = 0; e < editor.edges().size(); ++e) {
        const auto& [p, q, face] = editor.edges()[e];
        segments.push_back({editor.at(p), editor.at(q)});
        owner_.push_back({static_cast<int>(r), static_cast<Index>(e)});
        const Box reach = metric.around(editor.at(p), distance);
        widest = std::max({widest, reach.xmax - reach.xmin, reach.ymax - reach.ymin});
      }
    }
    index_.emplace(std::move(segments), 2 * widest);
  }

  SnappedTiles run(Context& context) {
    context.progress("snap", 0);
    vertices_to_vertices(context);
    context.progress("snap", 0.4);
    to_edges(true, context);
    to_edges(false, context);
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
  void vertices_to_vertices(const Context& context) {
    constexpr std::size_t enough = 32;  // of the nearest; each vertex is the end of two edges
    std::vector<Candidate> candidates, own;
    std::vector<Index> near;
    const auto key = [](const Candidate& c) {
      return std::tuple(c.rank, c.distance, c.from.x, c.from.y, c.to.x, c.to.y, c.target_rank);
    };
    for (int r = 0; r < static_cast<int>(moving_.size()); ++r)
      for (const Index v : moving_[r].editor.border()) {
        const Point2 p = moving_[r].editor.at(v);
        context.stop_if_cancelled();
        index_->near(metric_.around(p, distance_), near);
        for (const Index i : near) {
          const auto [rank, e] = owner_[i];
          if (rank >= r) continue;
          const BorderEditor& other = moving_[rank].editor;
          for (const Index target : {other.edges()[e].from, other.edges()[e].to}) {
            const Point2 q = other.at(target);
            const double d = metric_.distance(p, q);
            if (d <= distance_) own.push_back({r, d, p, q, v, rank, target});
          }
        }
        const auto kept = own.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(own.size(), enough));
        std::partial_sort(own.begin(), kept, own.end(), [&](auto& a, auto& b) { return key(a) < key(b); });
        candidates.insert(candidates.end(), own.begin(), kept);
        own.clear();
      }
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
    if (!tile.editor.can_move(v, to, own_edges(rank, tile.editor.box_of_border_at(v, to)))) {
      skipped_.emplace(rank, v);
      return false;
    }
    tile.editor.move(v, to);
    tile.state[v] = State::moved;
    tile.changed = true;
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
  void to_edges(bool free_ones, const Context& context) {
    std::vector<Index> near;
    for (int r = 0; r < static_cast<int>(moving_.size()); ++r)
      for (const Index v : moving_[r].editor.border()) {
        const bool is_free = moving_[r].state[v] == State::free;
        if (is_free != free_ones && free_ones) continue;
        const Point2 p = moving_[r].editor.at(v);
        context.stop_if_cancelled();
        index_->near(metric_.around(p, 2 * distance_), near);
        if (free_ones)
          onto_nearest_edge(r, v, p, near);
        else
          lead_edges_through(r, v, p, near);
      }
  }

  struct Way {
    auto key() const { return std::tuple(distance, foot.x, foot.y, rank); }
    double distance;
    Point2 foot;
    int rank;
    Index edge;
    BorderEditor::Nearest where;
  };

  /// The way from a place onto an edge of another tile, when the edge passes within the distance.
  std::optional<Way> way_onto(Point2 p, int rank, Index edge) const {
    const BorderEditor& other = moving_[rank].editor;
    const auto where = other.nearest(edge, p, metric_);
    if (where.distance > distance_ || where.t <= 0 || where.t >= 1) return {};
    return Way{where.distance, point_along(other.at(where.from), other.at(where.to), where.t), rank, edge, where};
  }
  bool lies_on(Point2 p, const Way& way) const {
    const BorderEditor& other = moving_[way.rank].editor;
    return orientation(other.at(way.where.from), other.at(way.where.to), p) == 0;
  }

  void onto_nearest_edge(int r, Index v, Point2 p, const std::vector<Index>& near) {
    std::optional<Way> best;
    for (const Index i : near) {
      const auto& [rank, edge] = owner_[i];
      if (rank == r || !moving_[rank].lies_where_it_lay(edge)) continue;
      const auto way = way_onto(p, rank, edge);
      if (way && (!best || way->key() < best->key())) best = way;
    }
    if (!best) return;
    Moving& other = moving_[best->rank];
    if (best->foot == p || lies_on(p, *best)) {
      moving_[r].state[v] = State::target;
      other.hold(best->edge);
      return;
    }
    if (!can_insert(*best, best->foot)) {
      skipped_.emplace(r, v);
      return;
    }
    if (!try_move(r, v, best->foot)) return;
    insert(*best, best->foot);
    other.hold(best->edge);
  }

  bool can_insert(const Way& way, Point2 p) {
    const BorderEditor& other = moving_[way.rank].editor;
    return other.can_insert(way.where, p, own_edges(way.rank, other.box_of(way.where, p)));
  }
  void insert(const Way& way, Point2 p) {
    Moving& other = moving_[way.rank];
    other.editor.insert(way.edge, way.where, p);
    other.state.push_back(State::target);
    other.changed = true;
  }

  void lead_edges_through(int r, Index v, Point2 p, const std::vector<Index>& near) {
    // The nearest edge of each other tile that has no vertex there yet.
    std::map<int, Way> ways;
    for (const Index i : near) {
      const auto& [rank, edge] = owner_[i];
      if (rank == r || moving_[rank].editor.stands_at(p)) continue;
      const auto way = way_onto(p, rank, edge);
      if (!way) continue;
      const auto [it, fresh] = ways.try_emplace(rank, *way);
      if (!fresh && way->key() < it->second.key()) it->second = *way;
    }
    for (const auto& [rank, way] : ways) {
      if (lies_on(p, way)) continue;  // conforming as it is
      if (can_insert(way, p))
        insert(way, p);
      else
        skipped_.emplace(r, v);
    }
  }

  /// A tile that verifies is taken, else it stays as it came.
  void take(std::size_t r, SnappedTiles& result) {
    const Moving& tile = moving_[r];
    SnapReport& report = result.report;
    std::size_t skipped = 0, moved = 0;
    for (const auto& [rank, v] : skipped_) skipped += rank == static_cast<int>(r) && tile.state[v] != State::moved;
    double sum = 0, largest = 0;
    for (const Index v : tile.editor.border())
      if (tile.state[v] == State::moved) {
        const double d = metric_.distance(tile.original[v], tile.editor.at(v));
        ++moved;
        sum += d;
        largest = std::max(largest, d);
      }
    if (tile.changed) {
      Tin tin = canonical(as_tin(tile.editor.piece()));
      const Inspection seen = inspect(tin);
      if (seen.inverted + seen.degenerate + seen.t_junctions + seen.non_manifold_edges + seen.overlaps > 0) {
        report.skipped += skipped + moved;
        return;
      }
      result.tiles[order_[r]] = std::move(tin);
    }
    report.skipped += skipped;
    report.moved += moved;
    report.inserted += tile.editor.made();
    report.max_move = std::max(report.max_move, largest);
    sum_ += sum;
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
