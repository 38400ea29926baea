// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge/merge_step.hpp"

#include <utility>
#include <vector>

#include "core/predicates.hpp"

namespace terrane {
namespace {

/// Whether what has accumulated covers the tile that is added.
bool pastes(const MergeOptions& options) {
  if (options.overlap == Overlap::blend) return options.blend.side != BlendSide::both;
  return !any_order(options.overlap);
}

/// with_tile() at work.
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

  Piece run(MergeReports& reports, Context& context) {
    OverlayOptions options;
    options.refinement = pastes(options_) ? Refinement::paste : Refinement::full;
    const Tin near = as_tin(near_), tile = as_tin(tile_);
    overlay_ = overlay(near, tile, options, context);
    if (policy_ == Overlap::min || policy_ == Overlap::max)
      overlay_ = split_where_surfaces_cross(std::move(overlay_), context);
    accumulate(reports.rounding, overlay_.rounding);
    if (policy_ == Overlap::blend && pastes(options_)) return bent(reports, context);
    if (policy_ == Overlap::blend) {
      Blended made = blend(std::move(overlay_), options_.blend, context);
      overlay_ = std::move(made.overlay);
      weight_ = std::move(made.weight);
      accumulate(reports.blend, made.report);
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
      return area2_accurate(tin, tin.faces[face]);
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
  Piece bent(MergeReports& reports, Context& context) {
    Bent made = bend(overlay_, options_.blend, context);
    accumulate(reports.rounding, made.rounding);
    accumulate(reports.blend, made.report);
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

}  // namespace

bool any_order(Overlap overlap) {
  return overlap != Overlap::first && overlap != Overlap::last && overlap != Overlap::blend;
}

bool is_firm(const Piece& from, Index parent, Point2 at) {
  for (int k = 0; k < 3; ++k)
    if (from.surface.points[from.surface.faces[parent][k]] == at)
      return from.surface.firm[3 * static_cast<std::size_t>(parent) + k];
  return false;
}

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

Piece with_tile(const Piece& near, const Piece& tile, int rank, const MergeOptions& options, ContributorSets& sets,
                Cells& cells, MergeReports& reports, Context& context) {
  return Step(near, tile, rank, options, sets, cells).run(reports, context);
}

}  // namespace terrane
