// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/overlay/mended_heights.hpp"
#include "core/surface.hpp"
#include "core/surface/edge_cuts.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

bool has_both(const Overlay& overlay, Index f) {
  return overlay.parents[f][0] != none && overlay.parents[f][1] != none;
}

double difference(const Overlay& overlay, Index f, int corner) {
  return overlay.height(0, f, corner) - overlay.height(1, f, corner);
}

std::vector<EdgeCut> crossings(const Overlay& overlay) {
  std::vector<EdgeCut> cuts;
  for (Index f = 0; f < static_cast<Index>(overlay.faces.size()); ++f) {
    if (!has_both(overlay, f)) continue;
    const double d[3] = {difference(overlay, f, 0), difference(overlay, f, 1), difference(overlay, f, 2)};
    for (int k = 0; k < 3; ++k) {
      const double dp = d[(k + 1) % 3], dq = d[(k + 2) % 3];
      if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0)) cuts.push_back({f, k, dp, dq});
    }
  }
  return cuts;
}

/// Carries parents and heights of an overlay onto its cut faces.
class Carrier {
 public:
  Carrier(const Overlay& before, const CutMesh& cut) : before_(before), cut_(cut) {
    after_.points = cut.mesh.points;
    after_.faces = cut.mesh.faces;
    after_.per_corner = before.per_corner;
    after_.rounding = before.rounding;
    accumulate(after_.rounding, cut.rounded.report);
    after_.rounding.regions = before.rounding.regions;
    after_.rounding.collapsed = before.rounding.collapsed;
    after_.parents.resize(after_.faces.size());
    for (std::size_t f = 0; f < after_.faces.size(); ++f) after_.parents[f] = before.parents[cut.mesh.labels[f]];
  }

  Overlay run() {
    for (int input : {0, 1}) carry(input);
    equated_.assign(after_.points.size(), 0);
    for (int input : {0, 1})
      if (after_.per_corner[1 - input] && !after_.per_corner[input]) hold_per_corner(input);
    equate();
    for (int input : {0, 1})
      if (!after_.per_corner[input]) mend(input);
    return std::move(after_);
  }

 private:
  double value(int input, std::size_t f, int corner) const {
    const Index label = cut_.mesh.labels[f];
    const double values[3] = {before_.height(input, label, 0), before_.height(input, label, 1),
                              before_.height(input, label, 2)};
    return value_on(cut_, before_.points, before_.faces[label], values, after_.faces[f][corner]);
  }

  void carry(int input) {
    Array<double>& heights = after_.heights[input];
    if (after_.per_corner[input]) {
      heights.assign(3 * after_.faces.size(), 0);
      for (std::size_t f = 0; f < after_.faces.size(); ++f)
        if (after_.parents[f][input] != none)
          for (int k = 0; k < 3; ++k) heights[3 * f + k] = value(input, f, k);
      return;
    }
    heights = before_.heights[input];
    heights.resize(after_.points.size(), 0);
    std::vector<std::uint8_t> known(after_.points.size(), 0);
    for (std::size_t f = 0; f < before_.faces.size(); ++f)
      if (before_.parents[f][input] != none)
        for (const Index v : before_.faces[f]) known[v] = 1;
    for (const bool strange : {false, true})  // faces that rounding brought to a vertex have no say where others know
      for (std::size_t f = 0; f < after_.faces.size(); ++f) {
        if (after_.parents[f][input] == none) continue;
        for (int k = 0; k < 3; ++k) {
          const Index v = after_.faces[f][k];
          if (known[v] || is_strange(f, v) != strange) continue;
          heights[v] = value(input, f, k);
          known[v] = 1;
        }
      }
  }

  bool is_strange(std::size_t f, Index v) const { return !is_on(cut_, before_.faces[cut_.mesh.labels[f]], v); }

  /// Where faces meet at a vertex that have its height not from a corner or an edge of their own.
  void mend(int input) {
    std::vector<Index> changed;
    for (std::size_t f = 0; f < after_.faces.size(); ++f) {
      const auto other = [&](Index v) { return equated_[v] || is_strange(f, v); };
      if (after_.parents[f][input] != none && std::any_of(after_.faces[f].begin(), after_.faces[f].end(), other))
        changed.push_back(static_cast<Index>(f));
    }
    const auto own_heights = [&](Index f) {
      const Index label = cut_.mesh.labels[f];
      const auto at = [&](int k) { return before_.points[before_.faces[label][k]]; };
      const auto z = [&](int k) { return before_.height(input, label, k); };
      return OwnHeights{{value(input, f, 0), value(input, f, 1), value(input, f, 2)},
                        height_error({at(0), at(1), at(2)}, {z(0), z(1), z(2)}, cut_.rounded.report.max_move)};
    };
    after_.per_corner[input] = mend_heights(after_.faces, changed, own_heights, after_.heights[input]);
  }

  /// Beside a surface that jumps: where the two are equated the flatter one decides, and may have several heights.
  void hold_per_corner(int input) {
    mend(input);
    if (std::exchange(after_.per_corner[input], true)) return;
    Array<double> corners(3 * after_.faces.size());
    for (std::size_t c = 0; c < corners.size(); ++c) corners[c] = after_.heights[input][after_.faces[c / 3][c % 3]];
    after_.heights[input] = std::move(corners);
  }

  /// Both heights at a vertex made for a face are one double there: that of the flatter surface, which stays flat. The
  /// same where rounding moved such a vertex onto another: the line passes within rounding of that one.
  void equate() {
    std::vector<Index> lands_on(after_.points.size(), none);  // chain of cut vertices that ended at a point
    std::vector<Index> next(cut_.made.size(), none);
    for (std::size_t i = 0; i < cut_.made.size(); ++i) {
      const Index w = cut_.rounded.merged_into[cut_.first_made + static_cast<Index>(i)];
      next[i] = lands_on[w];
      lands_on[w] = static_cast<Index>(i);
    }
    for (std::size_t f = 0; f < after_.faces.size(); ++f) {
      if (!has_both(after_, static_cast<Index>(f))) continue;
      const Index label = cut_.mesh.labels[f];
      for (int k = 0; k < 3; ++k) {
        if (difference(after_, static_cast<Index>(f), k) == 0) continue;
        // One height for all faces there: the flattest decides. A height per face: what others do is of no account.
        double least[2] = {INFINITY, INFINITY};
        bool here = false;
        for (Index i = lands_on[after_.faces[f][k]]; i != none; i = next[i])
          for (const Index owner : cut_.made[i].owners) {
            here = here || owner == label;
            for (int input : {0, 1})
              if (owner == label || (owner != none && !after_.per_corner[input]))
                least[input] = std::min(least[input], slope(owner, input));
          }
        if (here) equate(f, k, least[1] < least[0] ? 1 : 0);
      }
    }
  }

  /// Of a surface on a face of before. Not along the edge that a vertex was made on: the vertex may have left it, and a
  /// sliver that is level along its edge can be steep across it.
  double slope(Index face, int input) const {
    const Face& c = before_.faces[face];
    const auto z = [&](int k) { return before_.height(input, face, k); };
    return slope_of_triangle({before_.points[c[0]], before_.points[c[1]], before_.points[c[2]]}, {z(0), z(1), z(2)});
  }

  void equate(std::size_t f, int corner, int flatter) {
    const auto at = [&](int input) -> double& {
      return after_.heights[input][after_.per_corner[input] ? 3 * f + corner : after_.faces[f][corner]];
    };
    equated_[after_.faces[f][corner]] = 1;
    at(1 - flatter) = at(flatter);
  }

  const Overlay& before_;
  const CutMesh& cut_;
  Overlay after_;
  std::vector<std::uint8_t> equated_;  // by vertex
};

}  // namespace

Overlay split_where_surfaces_cross(Overlay overlay, Context& context) {
  const std::vector<EdgeCut> cuts = crossings(overlay);
  if (cuts.empty()) return overlay;
  PlanarMesh mesh{overlay.points, overlay.faces, {}, {}};
  connect(mesh);
  const CutMesh cut = cut_edges(std::move(mesh), cuts, Chords::between_own_cuts, context);
  return Carrier(overlay, cut).run();
}

}  // namespace terrane
