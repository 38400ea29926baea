// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge/median.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/corner_heights.hpp"
#include "core/error.hpp"
#include "core/merge/layers.hpp"
#include "core/overlay/mended_heights.hpp"
#include "core/surface/edge_cuts.hpp"

namespace terrane {
namespace {

/// The layers in the middle, one twice when their number is odd, in the order of `height(layer)`.
template <typename Height>
std::array<std::size_t, 2> middle(std::span<const Layer> layers, const Height& height) {
  if (layers.size() <= 2) return {0, layers.size() - 1};
  std::vector<std::size_t> order(layers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return height(layers[a]) < height(layers[b]); });
  return {order[(order.size() - 1) / 2], order[order.size() / 2]};
}

/// Two layers of a face that cross on it, as indices of its layers; the first lies in the middle.
struct Crossing {
  std::size_t inner = 0, other = 0;
  bool found = false;
};

bool cross(const Layer& a, const Layer& b, double tolerance) {
  bool above = false, below = false;
  for (int k = 0; k < 3; ++k) {
    const double d = a.z[k] - b.z[k];
    if (std::fabs(d) <= tolerance * std::max(1.0, std::fabs(a.z[k]))) continue;
    (d > 0 ? above : below) = true;
  }
  return above && below;
}

/// The width of a convex polygon of at most four corners.
double width(std::span<const Point2> polygon) {
  double least = INFINITY;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2 p = polygon[i], q = polygon[(i + 1) % polygon.size()];
    const double x = q.x - p.x, y = q.y - p.y, length = std::hypot(x, y);
    if (length == 0) continue;
    double farthest = 0;
    for (const Point2 r : polygon) farthest = std::max(farthest, std::fabs(x * (r.y - p.y) - y * (r.x - p.x)) / length);
    least = std::min(least, farthest);
  }
  return least;
}

/// Is one of the parts of a face where two layers have one order no wider than rounding? A cut would be rounded to the
/// border of that part, and settle nothing.
bool cross_within_rounding(const Layered& layered, Index f, const Layer& a, const Layer& b) {
  const Face& face = layered.faces[f];
  std::vector<Point2> above, below;
  double bound = 0;
  for (int k = 0; k < 3; ++k) {
    const Point2 p = layered.points[face[k]], q = layered.points[face[(k + 1) % 3]];
    const double dp = a.z[k] - b.z[k], dq = a.z[(k + 1) % 3] - b.z[(k + 1) % 3];
    if (dp >= 0) above.push_back(p);
    if (dp <= 0) below.push_back(p);
    if (!((dp < 0 && dq > 0) || (dp > 0 && dq < 0))) continue;
    const ExactPlace zero{.kind = ExactPlace::ratio, .p = p, .q = q, .dp = dp, .dq = dq};
    bound = std::max(bound, rounding_bound(zero));
    const double t = dp / (dp - dq);
    above.push_back({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
    below.push_back(above.back());
  }
  return std::min(width(above), width(below)) <= 3 * bound;
}

/// When every other layer lies on one side of those in the middle, they stay there all over the face.
Crossing unsettled(const Layered& layered, Index f, double tolerance, int round) {
  const auto layers = layered.of(f);
  if (layers.size() < 3) return {};
  const auto [m, n] = middle(layers, [](const Layer& layer) { return layer.z[0] + layer.z[1] + layer.z[2]; });
  // A cut that rounding undoes would be asked for again and again: from the fifth round on the others take turns.
  const std::size_t first = round < 4 ? 0 : static_cast<std::size_t>(round);
  const bool pass_narrow = round > 7;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const std::size_t j = (first + i) % layers.size();
    if (j == m || j == n) continue;
    for (const std::size_t inner : {m, n})
      if (cross(layers[inner], layers[j], tolerance) &&
          !(pass_narrow && cross_within_rounding(layered, f, layers[inner], layers[j])))
        return {inner, j, true};
  }
  return {};
}

/// One round of cuts: every unsettled face along one line.
class Round {
 public:
  Round(Layered before, double tolerance, int round) : before_(std::move(before)), crossings_(before_.faces.size()) {
    for (Index f = 0; f < static_cast<Index>(before_.faces.size()); ++f) {
      crossings_[f] = unsettled(before_, f, tolerance, round);
      if (crossings_[f].found) ask(f);
    }
  }

  bool settled() const { return cuts_.empty(); }

  Layered run(RoundingReport& report, Context& context) {
    if (settled()) return std::move(before_);
    PlanarMesh mesh{before_.points, before_.faces, {}, {}};
    connect(mesh);
    cut_ = cut_edges(std::move(mesh), cuts_, Chords::between_own_cuts, context);
    accumulate(report, cut_.rounded.report);
    list_landings();
    Layered after;
    after.first.push_back(0);
    for (std::size_t f = 0; f < cut_.mesh.faces.size(); ++f) {
      carry(f, after);
      after.first.push_back(after.layers.size());
    }
    after.points = std::move(cut_.mesh.points);
    after.faces = std::move(cut_.mesh.faces);
    mend(after);
    return after;
  }

 private:
  void ask(Index f) {
    const auto layers = before_.of(f);
    const Layer &a = layers[crossings_[f].inner], &b = layers[crossings_[f].other];
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const double dp = a.z[i] - b.z[i], dq = a.z[j] - b.z[j];
      if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0)) cuts_.push_back({f, k, dp, dq});
    }
  }

  /// Which cuts ended at a vertex, theirs or one that rounding brought them to.
  void list_landings() {
    last_landing_.assign(cut_.mesh.points.size(), none);
    landing_before_.assign(cut_.made.size(), none);
    for (std::size_t i = 0; i < cut_.made.size(); ++i) {
      const Index w = cut_.rounded.merged_into[cut_.first_made + static_cast<Index>(i)];
      landing_before_[i] = last_landing_[w];
      last_landing_[w] = static_cast<Index>(i);
    }
  }

  void carry(std::size_t f, Layered& after) {
    const Index label = cut_.mesh.labels[f];
    const Face& corners = cut_.mesh.faces[f];
    const std::size_t begin = after.layers.size();
    for (const Layer& old : before_.of(label)) {
      Layer layer{old.tile, {}, {0, 0, 0}, old.face, old.slope};
      for (int k = 0; k < 3; ++k) {
        layer.z[k] = value_on(cut_, before_.points, before_.faces[label], old.z, corners[k]);
        for (int j = 0; j < 3; ++j)
          if (before_.faces[label][j] == corners[k]) layer.firm[k] = old.firm[j];
      }
      after.layers.push_back(layer);
    }
    const std::span<Layer> layers{&after.layers[begin], after.layers.size() - begin};
    for (int k = 0; k < 3; ++k) {
      if (!is_on(cut_, before_.faces[label], corners[k])) continue;
      for (Index i = last_landing_[corners[k]]; i != none; i = landing_before_[i])
        for (const Index owner : cut_.made[i].owners)
          if (owner != none) equate(cut_.made[i], owner, label, k, layers);
    }
  }

  /// The height of a tile at a place.
  struct Known {
    Index place;
    int tile;
    double z;
    bool operator<(const Known& other) const {
      return std::tie(place, tile, z) < std::tie(other.place, other.tile, other.z);
    }
  };

  /// Faces that rounding brought to a vertex take the heights there of those that had it: theirs are read off planes
  /// past their ends.
  void mend(Layered& after) const {
    std::vector<std::uint8_t> has_strangers(after.points.size(), 0);
    const auto each_corner = [&](const auto& visit) {
      for (std::size_t f = 0; f < after.faces.size(); ++f)
        for (int k = 0; k < 3; ++k) visit(f, k, !is_on(cut_, before_.faces[cut_.mesh.labels[f]], after.faces[f][k]));
    };
    each_corner([&](std::size_t f, int k, bool strange) { has_strangers[after.faces[f][k]] |= strange; });
    std::vector<Known> known;
    each_corner([&](std::size_t f, int k, bool strange) {
      if (!strange && has_strangers[after.faces[f][k]])
        for (const Layer& layer : after.of(f)) known.push_back({after.faces[f][k], layer.tile, layer.z[k]});
    });
    std::sort(known.begin(), known.end());
    each_corner([&](std::size_t f, int k, bool strange) {
      if (!strange) return;
      for (Layer& layer : after.of(f)) {
        const Known own{after.faces[f][k], layer.tile, layer.z[k]};
        const auto same = [&](auto it) { return it->place == own.place && it->tile == own.tile; };
        const auto next = std::lower_bound(known.begin(), known.end(), own);
        double nearest = INFINITY;
        if (next != known.end() && same(next)) nearest = next->z;
        if (next != known.begin() && same(std::prev(next)) &&
            std::fabs(std::prev(next)->z - own.z) < std::fabs(nearest - own.z))
          nearest = std::prev(next)->z;
        if (nearest != INFINITY && error_of(f, layer).covers(own.z, nearest)) layer.z[k] = nearest;
      }
    });
  }

  HeightError error_of(std::size_t f, const Layer& layer) const {
    const Index label = cut_.mesh.labels[f];
    const Face& face = before_.faces[label];
    for (const Layer& old : before_.of(label))
      if (old.tile == layer.tile)
        return height_error({before_.points[face[0]], before_.points[face[1]], before_.points[face[2]]},
                            {old.z[0], old.z[1], old.z[2]}, cut_.rounded.report.max_move);
    return {0, 0, 0};
  }

  /// Both heights at a vertex made where they cross are one double there, on every face along whose edge they cross.
  void equate(const CutVertex& made, Index owner, Index label, int corner, std::span<Layer> layers) const {
    const auto asked = before_.of(owner);
    const int tile_a = asked[crossings_[owner].inner].tile, tile_b = asked[crossings_[owner].other].tile;
    Layer *a = nullptr, *b = nullptr;
    for (Layer& layer : layers) {
      if (layer.tile == tile_a) a = &layer;
      if (layer.tile == tile_b) b = &layer;
    }
    if (!a || !b) return;
    if (owner != label && !cross_alike(made, label, tile_a, tile_b)) return;
    // The flatter one stays flat: the one whose tile slopes less, not the one that rises less along the edge, which the
    // vertex may have left. The same on both sides of the edge.
    double slope_a = INFINITY, slope_b = INFINITY;
    for (const Index face : made.owners) {
      if (face != owner && (face == none || !cross_alike(made, face, tile_a, tile_b))) continue;
      slope_a = std::min(slope_a, slope(face, tile_a));
      slope_b = std::min(slope_b, slope(face, tile_b));
    }
    const bool a_stays = slope_a != slope_b ? slope_a < slope_b : tile_a < tile_b;
    (a_stays ? b : a)->z[corner] = (a_stays ? a : b)->z[corner];
    (a_stays ? b : a)->firm[corner] = (a_stays ? a : b)->firm[corner];
  }

  double height(Index place, Index face, int tile) const {
    const Face& corners = before_.faces[face];
    for (const Layer& layer : before_.of(face))
      if (layer.tile == tile)
        for (int k = 0; k < 3; ++k)
          if (corners[k] == place) return layer.z[k];
    return NAN;
  }
  double difference(Index place, Index face, int a, int b) const {
    return height(place, face, a) - height(place, face, b);
  }
  /// Do two tiles differ on `face` as those did that a vertex was made for?
  bool cross_alike(const CutVertex& made, Index face, int a, int b) const {
    const double dp = difference(made.p, face, a, b), dq = difference(made.q, face, a, b);
    return (dp == made.dp && dq == made.dq) || (dp == -made.dp && dq == -made.dq);
  }
  /// Of the tile itself: parts thinner than rounding slope as it pleases.
  double slope(Index face, int tile) const {
    const auto layers = before_.of(face);
    return std::find_if(layers.begin(), layers.end(), [&](const Layer& l) { return l.tile == tile; })->slope;
  }

  Layered before_;
  std::vector<Crossing> crossings_;
  std::vector<EdgeCut> cuts_;
  CutMesh cut_;
  std::vector<Index> last_landing_, landing_before_;
};

/// Of layers that lie over one place, two and two cross along one line at most; rounding may ask for some more rounds.
int most_rounds(const Layered& layered) {
  std::size_t most = 0;
  for (std::size_t f = 0; f < layered.faces.size(); ++f) most = std::max(most, layered.of(f).size());
  return static_cast<int>(std::min<std::size_t>(256, 16 + most * most));
}

Layered settled(Layered layered, RoundingReport& report, Context& context) {
  // Rounds are as many as lines cross one face. Surfaces that are equal but for rounding cross wherever it pleases:
  // what is left of such crossings is passed over by and by, up to what is welded anyway.
  double tolerance = 1e-12;
  const int most = most_rounds(layered);
  for (int round = 0; round < most; ++round) {
    context.progress("median", 1 - 1.0 / (1 + round));
    Round cuts(std::move(layered), tolerance, round);
    if (round >= 4) tolerance = std::min(1e-9, 4 * tolerance);
    const bool done = cuts.settled();
    layered = cuts.run(report, context);
    if (done) return layered;
  }
  throw Error(ErrorKind::input, "rounding",
              "the surfaces cross each other too often within rounding for their median; use coordinates nearer the "
              "origin, or overlap=mean");
}

}  // namespace

Piece median_surface(const std::vector<Tin>& tiles, const std::vector<int>& order, ContributorSets& sets,
                     RoundingReport& report, Context& context, std::vector<std::array<Index, 2>>* lowest) {
  Layered layered = settled(layers_of(tiles, order, report, context), report, context);
  Piece piece;
  for (std::size_t f = 0; f < layered.faces.size(); ++f) {
    const auto layers = layered.of(f);
    for (int k = 0; k < 3; ++k) {
      // At every corner anew: on a face passed over the order may differ from corner to corner, and the surface stays
      // in one piece, since at a vertex the same heights are there for all its faces.
      const auto [m, n] = middle(layers, [k](const Layer& layer) { return layer.z[k]; });
      const double low = layers[m].z[k], high = layers[n].z[k];
      piece.surface.z.push_back(low + (high - low) / 2);
      piece.surface.firm.push_back(m == n && layers[m].firm[k]);
    }
    Index set = sets.single(layers[0].tile);
    for (std::size_t l = 1; l < layers.size(); ++l) set = sets.with(set, layers[l].tile);
    piece.contributors.push_back(set);
    if (lowest) lowest->push_back({layers[0].tile, layers[0].face});
  }
  piece.surface.points = std::move(layered.points);
  piece.surface.faces = std::move(layered.faces);
  return piece;
}

}  // namespace terrane
