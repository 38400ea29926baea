// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "core/box.hpp"
#include "core/corner_heights.hpp"
#include "core/merge/median.hpp"
#include "core/merge/merge_step.hpp"
#include "core/merge/seams.hpp"
#include "core/predicates.hpp"
#include "core/side_by_side.hpp"

namespace terrane {
namespace {

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

/// How far a tile changes what is there.
Box reach_of(const Box& tile, const MergeOptions& options) {
  const Box box = widened(tile);
  if (options.overlap != Overlap::blend || options.blend.side != BlendSide::inside) return box;
  const double dx = 4 * options.blend.width / options.blend.metric.x;
  const double dy = 4 * options.blend.width / options.blend.metric.y;
  return {box.xmin - dx, box.ymin - dy, box.xmax + dx, box.ymax + dy};
}

Piece accumulate_tiles(const std::vector<Tin>& tiles, const std::vector<int>& order, const MergeOptions& options,
                       ContributorSets& sets, MergeReports& reports, Context& context) {
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
      near = with_tile(near, tile.near, static_cast<int>(rank), options, sets, cells, reports, context);
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
    return area2_accurate(tile, tile.faces[without_walls[rank][face]]);
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
  MergeReports reports;
  Piece piece = options.overlap == Overlap::median
                    ? median_tiles(tiles, order, options.assembly.seam, sets, reports.rounding, context)
                    : accumulate_tiles(tiles, order, options, sets, reports, context);
  merged.blend = reports.blend;
  if (options.level) piece = clamped(std::move(piece), *options.level, options.overlap, reports.rounding, context);
  merged.bridged = bridge_gaps(piece, sets, options.gap, options.metric, context);
  sort_by_contributor(piece, sets);
  find_jumps(merged, piece, sets, order, options);
  std::vector<std::uint8_t> slopes;
  for (const Index set : piece.contributors) slopes.push_back(sets.is_sloped(set));
  Tin ramps = faces_in_plan(piece.surface.points, piece.surface.faces, slopes);
  merged.surface = assemble(std::move(piece.surface), options.assembly, context);
  merged.surface.ramps = std::move(ramps);
  accumulate(merged.surface.rounding, reports.rounding);
  return merged;
}

}  // namespace terrane
