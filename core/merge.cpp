// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "core/corner_heights.hpp"
#include "core/median.hpp"
#include "core/mosaic.hpp"
#include "core/needless.hpp"
#include "core/predicates.hpp"
#include "core/ramp.hpp"
#include "core/seams.hpp"
#include "core/side_by_side.hpp"

namespace terrane {
namespace {

/// Whether the order of the tiles given must not matter.
bool any_order(Overlap overlap) {
  return overlap != Overlap::first && overlap != Overlap::last && overlap != Overlap::blend;
}

/// Whether what has accumulated covers the tile that is added.
bool pastes(const MergeOptions& options) {
  if (options.overlap == Overlap::blend) return options.blend.side != BlendSide::both;
  return !any_order(options.overlap);
}

std::vector<int> by_content(const std::vector<Tin>& tiles, std::vector<int> order) {
  std::vector<Box> boxes;
  for (const Tin& tile : tiles) boxes.push_back(bounds(tile));
  const auto key = [&](int t) {
    const Box& b = boxes[t];
    return std::tuple(b.xmin, b.ymin, b.xmax, b.ymax, tiles[t].vertices.size(), tiles[t].faces.size());
  };
  const auto content_before = [&](int a, int b) {
    const Tin s = canonical(tiles[a]), t = canonical(tiles[b]);
    const auto differ = std::mismatch(s.vertices.begin(), s.vertices.end(), t.vertices.begin(), t.vertices.end());
    if (differ.first != s.vertices.end() && differ.second != t.vertices.end()) {
      const Point &p = *differ.first, &q = *differ.second;
      return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
    }
    return s.faces < t.faces;
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return key(a) != key(b) ? key(a) < key(b) : content_before(a, b); });
  return order;
}

/// Non-empty tiles in the order in which they are merged.
std::vector<int> merge_order(const std::vector<Tin>& tiles, Overlap overlap) {
  std::vector<int> order;
  for (int t = 0; t < static_cast<int>(tiles.size()); ++t)
    if (!tiles[t].faces.empty()) order.push_back(t);
  if (overlap == Overlap::last) std::reverse(order.begin(), order.end());
  return any_order(overlap) ? by_content(tiles, std::move(order)) : order;
}

/// Whether the height of a face at a place is an input's own.
bool is_firm(const Piece& from, Index parent, Point2 at) {
  for (int k = 0; k < 3; ++k)
    if (from.surface.points[from.surface.faces[parent][k]] == at)
      return from.surface.firm[3 * static_cast<std::size_t>(parent) + k];
  return false;
}

double area_in_plan(const Tin& tin, const Face& f) {
  return area2_accurate(plan(tin.vertices[f[0]]), plan(tin.vertices[f[1]]), plan(tin.vertices[f[2]]));
}

/// With its jumps sloped; the sets of faces say which slope.
Piece sloped(Piece piece, const RampGround& ground, Meeting meeting, ContributorSets& sets, Cells& cells,
             Context& context) {
  Ramped ramped = ramp(std::move(piece.surface), ground, meeting, context);
  Piece result{std::move(ramped.surface), {}};
  for (std::size_t f = 0; f < ramped.from.size(); ++f) {
    const Index set = piece.contributors[ramped.from[f]];
    result.contributors.push_back(ramped.sloped[f] ? sets.sloped(set) : set);
    if (!piece.cells.empty()) result.cells.push_back(ramped.sloped[f] ? cells.fresh() : piece.cells[ramped.from[f]]);
  }
  return result;
}

/// One tile on top of, under, or mixed with what has accumulated near it.
class Step {
 public:
  Step(const Piece& near, const Piece& tile, int rank, const MergeOptions& options, ContributorSets& sets, Cells& cells)
      : near_(near),
        tile_(tile),
        rank_(rank),
        policy_(options.overlap),
        options_(options),
        sets_(sets),
        cells_(cells) {}

  Piece run(RoundingReport& report, BlendReport& blended, Context& context) {
    OverlayOptions options;
    options.refinement = pastes(options_) ? Refinement::paste : Refinement::full;
    const Tin near = as_tin(near_), tile = as_tin(tile_);
    overlay_ = overlay(near, tile, options, context);
    if (policy_ == Overlap::min || policy_ == Overlap::max)
      overlay_ = split_where_surfaces_cross(std::move(overlay_), context);
    accumulate(report, overlay_.rounding);
    if (policy_ == Overlap::blend && pastes(options_)) return bent(report, blended, context);
    if (policy_ == Overlap::blend) {
      Blended made = blend(std::move(overlay_), options_.blend, context);
      overlay_ = std::move(made.overlay);
      weight_ = std::move(made.weight);
      accumulate(blended, made.report);
    }
    Piece result;
    result.surface.points = std::move(overlay_.points);
    points_ = &result.surface.points;
    result.surface.faces = overlay_.faces;
    for (Index f = 0; f < static_cast<Index>(overlay_.faces.size()); ++f) fold(f, result);
    if (options_.assembly.seam == Seam::ramp) result = slope(near, tile, std::move(result), context);
    if (!any_order(policy_)) return result;
    return without_needless(std::move(result), near_, tile_, 2 * overlay_.rounding.max_move);
  }

 private:
  void fold(Index f, Piece& result) {
    const auto [a, b] = overlay_.parents[f];
    const bool mixed = a != none && b != none && (policy_ == Overlap::mean || policy_ == Overlap::sum);
    if (mixed) {
      const Index set = near_.contributors[a];
      const double count = static_cast<double>(sets_.members(set).size());
      for (int k = 0; k < 3; ++k) {
        const double za = overlay_.height(0, f, k), zb = overlay_.height(1, f, k);
        // The running mean: equal heights stay what they are, however many tiles share them.
        result.surface.z.push_back(policy_ == Overlap::sum ? za + zb : za + (zb - za) / (count + 1));
        result.surface.firm.push_back(0);
      }
      result.contributors.push_back(sets_.with(set, rank_));
      result.cells.push_back(cells_.both(near_.cells[a], tile_.cells[b]));
      return;
    }
    if (a != none && b != none && policy_ == Overlap::blend && fades(f)) return fade(f, result);
    const int winner = a == none || (b != none && tile_wins(f)) ? 1 : 0;
    const Piece& from = winner == 0 ? near_ : tile_;
    const Index parent = winner == 0 ? a : b;
    bool beaten = false;
    for (int k = 0; k < 3; ++k) {
      const Point2 at = (*points_)[overlay_.faces[f][k]];
      const int shown = is_firm(from, parent, at) && is_beaten(winner, f, k) ? 1 - winner : winner;
      beaten = beaten || shown != winner;
      result.surface.z.push_back(overlay_.height(shown, f, k));
      result.surface.firm.push_back(is_firm(shown == 0 ? near_ : tile_, overlay_.parents[f][shown], at));
    }
    // Of one cell is what lies on the same faces and has one winner.
    result.cells.push_back(beaten                   ? cells_.fresh()
                           : a == none || b == none ? from.cells[parent]
                           : winner == 0            ? cells_.both(near_.cells[a], tile_.cells[b])
                                                    : cells_.both(tile_.cells[b], near_.cells[a]));
    // What wins over a ramp need not win over what the ramp replaced.
    const bool over_ramp = winner == 1 && a != none && sets_.is_sloped(near_.contributors[a]);
    result.contributors.push_back(over_ramp ? sets_.sloped(from.contributors[parent]) : from.contributors[parent]);
  }

  /// A tile pasted over keeps its heights wherever it is; else those of the overlap are kept. A mean of more tiles
  /// jumps against one of fewer, though both surfaces are continuous.
  Piece slope(const Tin& near, const Tin& tile, Piece result, Context& context) const {
    RampGround ground;
    for (std::size_t f = 0; f < overlay_.parents.size(); ++f) {
      const auto& [a, b] = overlay_.parents[f];
      const bool held = a != none && (b != none || pastes(options_));
      const auto count = static_cast<int>(sets_.members(result.contributors[f]).size());
      ground.rank.push_back(!held ? 0 : policy_ == Overlap::mean ? count : 1);
      ground.origin.push_back(a != none ? std::array<Index, 2>{0, a} : std::array<Index, 2>{1, b});
    }
    ground.area = [&](Index input, Index face) {
      const Tin& tin = input == 0 ? near : tile;
      return area_in_plan(tin, tin.faces[face]);
    };
    const Meeting meeting = policy_ == Overlap::min   ? Meeting::lower
                            : policy_ == Overlap::max ? Meeting::higher
                                                      : Meeting::mean;
    const std::vector<Index> classes = result.contributors;
    ground.classes = &classes;
    return sloped(std::move(result), ground, meeting, sets_, cells_, context);
  }

  double weight(Index f, int k) const { return weight_[3 * static_cast<std::size_t>(f) + k]; }
  bool fades(Index f) const {
    for (int k = 0; k < 3; ++k)
      if (weight(f, k) != weight(f, 0)) return true;
    return weight(f, 0) > 0 && weight(f, 0) < 1;
  }

  void fade(Index f, Piece& result) const {
    for (int k = 0; k < 3; ++k) {
      const double za = overlay_.height(0, f, k), zb = overlay_.height(1, f, k), w = weight(f, k);
      result.surface.z.push_back(w == 1 ? za : zb + w * (za - zb));
      result.surface.firm.push_back(0);
    }
    result.contributors.push_back(sets_.with(near_.contributors[overlay_.parents[f][0]], rank_));
    result.cells.push_back(cells_.fresh());
  }

  /// Pasted, with the one bent to the other beside the seam.
  Piece bent(RoundingReport& report, BlendReport& blended, Context& context) {
    Bent made = bend(overlay_, options_.blend, context);
    accumulate(report, made.rounding);
    accumulate(blended, made.report);
    Piece result{std::move(made.surface), {}};
    for (std::size_t f = 0; f < made.from.size(); ++f) {
      const auto [a, b] = overlay_.parents[made.from[f]];
      const Piece& from = a != none ? near_ : tile_;
      const Index parent = a != none ? a : b, set = from.contributors[parent];
      for (const Index v : result.surface.faces[f])
        result.surface.firm.push_back(!made.sloped[f] && is_firm(from, parent, result.surface.points[v]));
      result.contributors.push_back(made.sloped[f] ? sets_.sloped(set) : set);
      result.cells.push_back(made.sloped[f] ? cells_.fresh() : from.cells[parent]);
    }
    return result;
  }

  bool tile_wins(Index f) const {
    if (policy_ == Overlap::blend) return weight(f, 0) == 0;
    if (policy_ != Overlap::min && policy_ != Overlap::max) return false;
    double above = 0;
    for (int k = 0; k < 3; ++k) above += overlay_.height(1, f, k) - overlay_.height(0, f, k);
    return policy_ == Overlap::max ? above > 0 : above < 0;
  }

  /// Rounding may flip a sliver across the line where the two cross, along which heights change much: then the winner
  /// is not the one to be seen at each of its own vertices. Crossings, which rounding moves, say nothing of that.
  bool is_beaten(int winner, Index f, int k) const {
    const auto [a, b] = overlay_.parents[f];
    if (a == none || b == none || (policy_ != Overlap::min && policy_ != Overlap::max)) return false;
    const double shown = overlay_.height(winner, f, k), hidden = overlay_.height(1 - winner, f, k);
    return policy_ == Overlap::max ? hidden > shown : hidden < shown;
  }

  const Piece& near_;
  const Piece& tile_;
  int rank_;
  Overlap policy_;
  const MergeOptions& options_;
  ContributorSets& sets_;
  Cells& cells_;
  Overlay overlay_;
  std::vector<double> weight_;  // of near, where the two are blended
  const Array<Point2>* points_ = nullptr;
};

/// How far a tile changes what is there.
Box reach_of(const Box& tile, const MergeOptions& options) {
  const Box box = widened(tile);
  if (options.overlap != Overlap::blend || options.blend.side != BlendSide::inside) return box;
  const double dx = 4 * options.blend.width / options.blend.metric.x;
  const double dy = 4 * options.blend.width / options.blend.metric.y;
  return {box.xmin - dx, box.ymin - dy, box.xmax + dx, box.ymax + dy};
}

Piece accumulate_tiles(const std::vector<Tin>& tiles, const std::vector<int>& order, const MergeOptions& options,
                       ContributorSets& sets, RoundingReport& report, BlendReport& blended, Context& context) {
  Mosaic mosaic;
  Cells cells;
  std::vector<Box> earlier;
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    context.progress("merge", static_cast<double>(rank) / static_cast<double>(order.size()));
    Piece whole = piece_of(tiles[order[rank]], sets.single(static_cast<int>(rank)));
    for (std::size_t f = 0; f < whole.contributors.size(); ++f) whole.cells.push_back(cells.fresh());
    const Box box = reach_of(bounds(tiles[order[rank]]), options);
    std::vector<Box> met;
    std::copy_if(earlier.begin(), earlier.end(), std::back_inserter(met),
                 [&](const Box& b) { return touches(b, box); });
    if (options.overlap == Overlap::blend) met = {box};  // borders far from where tiles meet have a say
    const Parted tile = parted(whole, met);
    earlier.push_back(box);
    Piece near = mosaic.take_near(box);
    if (!near.contributors.empty() && !tile.near.contributors.empty()) {
      near = Step(near, tile.near, static_cast<int>(rank), options, sets, cells).run(report, blended, context);
      // Heights that two routes computed are made equal at once, or the next tile would meet jumps of an ulp. Every
      // other face at a place inside the box is at hand; elsewhere nothing has changed.
      const CornersByPlace places = corners_by_place(near.surface.faces, near.surface.points.size());
      close_jumps(near.surface, places, 0, [&](Point2 p) {
        return touches({p.x, p.y, p.x, p.y}, box) && !tile.is_shared(p);
      });
    } else {
      mosaic.add(tile.near);
    }
    mosaic.add(near);
    mosaic.add(tile.far);
  }
  return mosaic.take_all();
}

/// The median, whose overlaps of more tiles hold against those of fewer.
Piece median_tiles(const std::vector<Tin>& tiles, const std::vector<int>& order, Seam seam, ContributorSets& sets,
                   RoundingReport& report, Context& context) {
  RampGround ground;
  Piece piece = median_surface(tiles, order, sets, report, context, &ground.origin);
  if (seam != Seam::ramp) return piece;
  std::vector<std::vector<Index>> without_walls(order.size());
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const Tin& tile = tiles[order[rank]];
    for (Index f = 0; f < static_cast<Index>(tile.faces.size()); ++f)
      if (!is_wall(tile, tile.faces[f])) without_walls[rank].push_back(f);
  }
  for (const Index set : piece.contributors) ground.rank.push_back(static_cast<int>(sets.members(set).size()) - 1);
  ground.area = [&](Index rank, Index face) {
    const Tin& tile = tiles[order[rank]];
    return area_in_plan(tile, tile.faces[without_walls[rank][face]]);
  };
  const std::vector<Index> classes = piece.contributors;
  ground.classes = &classes;
  Cells cells;
  return sloped(std::move(piece), ground, Meeting::mean, sets, cells, context);
}

/// The surface cut off at a level: what lies beyond it becomes level. The level is one more surface wherever there is
/// one, so the cuts are those of any min or max.
Piece clamped(Piece piece, double level, Overlap policy, RoundingReport& report, Context& context) {
  Overlay both;
  both.points = piece.surface.points;
  both.faces = piece.surface.faces;
  for (Index f = 0; f < static_cast<Index>(both.faces.size()); ++f) both.parents.push_back({f, f});
  both.heights[0].assign(piece.surface.z.begin(), piece.surface.z.end());
  both.per_corner[0] = true;
  both.heights[1].assign(both.points.size(), level);
  both = split_where_surfaces_cross(std::move(both), context);
  accumulate(report, both.rounding);
  Piece result;
  result.surface.points = std::move(both.points);
  for (Index f = 0; f < static_cast<Index>(both.faces.size()); ++f) {
    const Index parent = both.parents[f][0];
    for (int k = 0; k < 3; ++k) {
      const double z = both.height(0, f, k);
      const bool level_wins = policy == Overlap::max ? z < level : z > level;
      result.surface.z.push_back(level_wins ? level : z);
      result.surface.firm.push_back(level_wins || z == level ||
                                    is_firm(piece, parent, result.surface.points[both.faces[f][k]]));
    }
    result.contributors.push_back(piece.contributors[parent]);
  }
  result.surface.faces = std::move(both.faces);
  return result;
}

/// z_tolerance closes at the height of the tile that goes before.
void sort_by_contributor(Piece& piece, const ContributorSets& sets) {
  std::vector<std::size_t> order(piece.contributors.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t f, std::size_t g) {
    return sets.members(piece.contributors[f]) < sets.members(piece.contributors[g]);
  });
  Piece sorted;
  sorted.surface.points = std::move(piece.surface.points);
  for (const std::size_t f : order) {
    sorted.surface.faces.push_back(piece.surface.faces[f]);
    sorted.contributors.push_back(piece.contributors[f]);
    for (std::size_t c = 3 * f; c < 3 * f + 3; ++c) {
      sorted.surface.z.push_back(piece.surface.z[c]);
      sorted.surface.firm.push_back(piece.surface.firm[c]);
    }
  }
  piece = std::move(sorted);
}

std::vector<SeamPair> compare_all(const std::vector<Tin>& tiles, const std::vector<int>& order,
                                  const PlanMetric& metric, Context& context) {
  std::vector<Box> boxes;
  for (const Tin& tile : tiles) boxes.push_back(bounds(tile));
  std::vector<int> by_index = order;
  std::sort(by_index.begin(), by_index.end());
  std::vector<std::pair<int, int>> neighbours;
  for (std::size_t i = 0; i < by_index.size(); ++i)
    for (std::size_t j = i + 1; j < by_index.size(); ++j)
      if (touches(widened(boxes[by_index[i]]), boxes[by_index[j]])) neighbours.push_back({by_index[i], by_index[j]});
  std::vector<double> sizes;
  for (const auto& [a, b] : neighbours)
    sizes.push_back(static_cast<double>(tiles[a].faces.size() + tiles[b].faces.size()));
  std::vector<std::optional<SeamPair>> compared(neighbours.size());
  side_by_side(sizes, context, [&](std::size_t i, Context& own) {
    own.progress("seams", static_cast<double>(i) / static_cast<double>(neighbours.size()));
    const auto [a, b] = neighbours[i];
    compared[i] = compare_tiles(tiles[a], tiles[b], metric, own);
  });
  std::vector<SeamPair> pairs;
  for (std::size_t i = 0; i < neighbours.size(); ++i)
    if (compared[i]) {
      pairs.push_back(*compared[i]);
      std::tie(pairs.back().a, pairs.back().b) = neighbours[i];
    }
  return pairs;
}

/// Pairs know tiles by their index, contributors by their rank.
void find_jumps(Merged& merged, const Piece& piece, const ContributorSets& sets, const std::vector<int>& order,
                const MergeOptions& options) {
  std::vector<int> rank(order.empty() ? 0 : *std::max_element(order.begin(), order.end()) + 1, 0);
  for (std::size_t r = 0; r < order.size(); ++r) rank[order[r]] = static_cast<int>(r);
  for (SeamPair& pair : merged.seams) pair.a = rank[pair.a], pair.b = rank[pair.b];
  merged.jumps = attribute_jumps(piece.surface, piece.contributors, sets, options.assembly.z_tolerance,
                                 options.assembly.seam != Seam::split, options.metric, merged.seams);
  for (SeamPair& pair : merged.seams) {
    pair.a = order[pair.a], pair.b = order[pair.b];
    if (pair.a > pair.b) std::swap(pair.a, pair.b);
  }
  for (SeamJump& jump : merged.jumps) {
    jump.a = order[jump.a], jump.b = order[jump.b];
    if (jump.a > jump.b) std::swap(jump.a, jump.b), jump.dp = -jump.dp, jump.dq = -jump.dq;
    if (std::tie(jump.q.x, jump.q.y) < std::tie(jump.p.x, jump.p.y))
      std::swap(jump.p, jump.q), std::swap(jump.dp, jump.dq);
  }
  const auto by_tiles = [](auto& p, auto& q) { return std::tie(p.a, p.b) < std::tie(q.a, q.b); };
  std::sort(merged.seams.begin(), merged.seams.end(), by_tiles);
  std::sort(merged.jumps.begin(), merged.jumps.end(), [](const SeamJump& s, const SeamJump& t) {
    return std::tie(s.a, s.b, s.p.x, s.p.y, s.q.x, s.q.y) < std::tie(t.a, t.b, t.p.x, t.p.y, t.q.x, t.q.y);
  });
}

}  // namespace

std::vector<int> order_by_content(const std::vector<Tin>& tiles) {
  std::vector<int> order(tiles.size());
  std::iota(order.begin(), order.end(), 0);
  return by_content(tiles, std::move(order));
}

Merged merge(const std::vector<Tin>& tiles, const MergeOptions& options, Context& context) {
  const std::vector<int> order = merge_order(tiles, options.overlap);
  Merged merged;
  if (order.empty()) return merged;
  if (order.size() == 1 && !options.level) {
    merged.surface.tin = canonical(tiles[order[0]]);
    return merged;
  }
  merged.seams = compare_all(tiles, order, options.metric, context);
  ContributorSets sets(static_cast<int>(order.size()));
  RoundingReport report;
  Piece piece = options.overlap == Overlap::median
                    ? median_tiles(tiles, order, options.assembly.seam, sets, report, context)
                    : accumulate_tiles(tiles, order, options, sets, report, merged.blend, context);
  if (options.level) piece = clamped(std::move(piece), *options.level, options.overlap, report, context);
  merged.bridged = bridge_gaps(piece, sets, options.gap, options.metric, context);
  sort_by_contributor(piece, sets);
  find_jumps(merged, piece, sets, order, options);
  std::vector<std::uint8_t> slopes;
  for (const Index set : piece.contributors) slopes.push_back(sets.is_sloped(set));
  Tin ramps = faces_in_plan(piece.surface.points, piece.surface.faces, slopes);
  merged.surface = assemble(std::move(piece.surface), options.assembly, context);
  merged.surface.ramps = std::move(ramps);
  accumulate(merged.surface.rounding, report);
  return merged;
}

}  // namespace terrane
