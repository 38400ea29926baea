// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge/seams.hpp"

#include <algorithm>
#include <cmath>

#include "core/area_quantile.hpp"
#include "core/corner_heights.hpp"
#include "core/predicates.hpp"
#include "core/rounding/rounding.hpp"
#include "core/sum.hpp"

namespace terrane {
namespace {

double area_of(const Overlay& overlay, const Face& f) {
  return 0.5 * area2_accurate(overlay.points[f[0]], overlay.points[f[1]], overlay.points[f[2]]);
}

std::vector<LinearPiece> differences(const Overlay& overlay, const PlanMetric& metric) {
  std::vector<LinearPiece> pieces;
  for (Index f = 0; f < static_cast<Index>(overlay.faces.size()); ++f) {
    if (overlay.parents[f][0] == none || overlay.parents[f][1] == none) continue;
    const Face& c = overlay.faces[f];
    const Point2 unit = metric.at((overlay.points[c[0]].y + overlay.points[c[1]].y + overlay.points[c[2]].y) / 3);
    LinearPiece piece{area_of(overlay, c) * unit.x * unit.y, {}};
    for (int k = 0; k < 3; ++k) piece.values[k] = overlay.height(1, f, k) - overlay.height(0, f, k);
    pieces.push_back(piece);
  }
  return pieces;
}

/// Whether a face of A alone and a face of B alone share an edge.
bool share_border(const Overlay& overlay) {
  PlanarMesh mesh{overlay.points, overlay.faces, {}, {}};
  connect(mesh);
  for (std::size_t f = 0; f < overlay.faces.size(); ++f)
    for (const Index g : mesh.neighbours[f]) {
      if (g == none) continue;
      const auto &p = overlay.parents[f], &q = overlay.parents[g];
      if (p[0] != none && p[1] == none && q[0] == none && q[1] != none) return true;
    }
  return false;
}

void describe(const std::vector<LinearPiece>& pieces, double largest_height, SeamPair& pair) {
  Sum area, integral, squares, area_squares;
  for (const LinearPiece& p : pieces) {
    const auto& [u, v, w] = p.values;
    area.add(p.area);
    area_squares.add(p.area * p.area);
    integral.add(p.area * (u + v + w) / 3);
    squares.add(p.area * (u * u + v * v + w * w + u * v + v * w + w * u) / 6);
  }
  const double total = area.value();
  pair.overlap_area_2d = total;
  pair.dz_mean = integral.value() / total;
  pair.dz_rmse = std::sqrt(std::max(0.0, squares.value() / total));
  pair.dz_median = area_quantile(pieces, 0.5);
  pair.dz_nmad = 1.4826 * area_quantile_abs(pieces, pair.dz_median, 0.5);
  pair.dz_p95_abs = area_quantile_abs(pieces, 0, 0.95);
  // Kish's effective number of samples: faces weigh by their area.
  const double samples = total * total / area_squares.value();
  pair.bias_suspected = samples >= 10 && std::fabs(pair.dz_median) > rounding_jump(largest_height) &&
                        std::fabs(pair.dz_median) > 3 * pair.dz_nmad / std::sqrt(samples);
}

double tile_area(const Tin& tin) {
  Sum area;
  for (const Face& f : tin.faces)
    if (!is_wall(tin, f)) area.add(0.5 * area2_accurate(tin, f));
  return area.value();
}

double largest_height(const Tin& a, const Tin& b) {
  double largest = 0;
  for (const Tin* tin : {&a, &b})
    for (const Point& p : tin->vertices) largest = std::max(largest, std::fabs(p.z));
  return largest;
}

/// The tiles a jump between two sets of contributors is due to: those that are on one side only, else any on both.
std::pair<int, int> responsible(const std::vector<int>& s, const std::vector<int>& t) {
  const auto only = [](const std::vector<int>& in, const std::vector<int>& out) {
    for (const int tile : in)
      if (!std::binary_search(out.begin(), out.end(), tile)) return tile;
    return -1;
  };
  int a = only(s, t), b = only(t, s);
  const auto other = [](const std::vector<int>& in, int than) {
    for (const int tile : in)
      if (tile != than) return tile;
    return than;
  };
  if (a < 0) a = other(s, b);
  if (b < 0) b = other(t, a);
  return std::minmax(a, b);
}

/// Whether, of two sides of a jump, the first is b's of its pair.
bool lies_on(const std::vector<int>& first, const std::vector<int>& second, const SeamPair& pair) {
  const auto has = [](const std::vector<int>& tiles, int tile) {
    return std::binary_search(tiles.begin(), tiles.end(), tile);
  };
  if (has(first, pair.b) != has(second, pair.b)) return has(first, pair.b);
  return has(second, pair.a);
}

/// The jumps of one pair while they are summed up.
class Jumps {
 public:
  Jumps(SeamPair& pair, const PlanMetric& metric) : pair_(pair), metric_(metric) {}

  void add(Point2 p, Point2 q, double dp, double dq) {
    const double length = metric_.distance(p, q);
    ++pair_.jump_count;
    length_.add(length);
    const double one_sign = 0.5 * (std::fabs(dp) + std::fabs(dq));
    absolute_.add(length * (dp * dq >= 0 ? one_sign : 0.5 * (dp * dp + dq * dq) / (std::fabs(dp) + std::fabs(dq))));
    squares_.add(length * (dp * dp + dp * dq + dq * dq) / 3);
    for (const auto& [at, d] : {std::pair(p, std::fabs(dp)), std::pair(q, std::fabs(dq))}) {
      const bool earlier = at.x < pair_.jump_max_at.x || (at.x == pair_.jump_max_at.x && at.y < pair_.jump_max_at.y);
      if (d < pair_.jump_max_abs || (d == pair_.jump_max_abs && !earlier)) continue;
      pair_.jump_max_abs = d;
      pair_.jump_max_at = at;
    }
  }

  void finish(bool made_walls) {
    if (pair_.jump_count == 0) return;
    pair_.jump_length_2d = length_.value();
    pair_.jump_mean_abs = absolute_.value() / length_.value();
    pair_.jump_rmse = std::sqrt(squares_.value() / length_.value());
    pair_.wall_area = made_walls ? absolute_.value() : 0;
  }

 private:
  SeamPair& pair_;
  const PlanMetric& metric_;
  Sum length_, absolute_, squares_;
};

}  // namespace

std::optional<SeamPair> compare_tiles(const Tin& a, const Tin& b, const PlanMetric& metric, Context& context) {
  const Tin near_a = near_faces(a, widened(bounds(b))), near_b = near_faces(b, widened(bounds(a)));
  if (near_a.faces.empty() || near_b.faces.empty()) return std::nullopt;
  const Overlay overlaid = overlay(near_a, near_b, {}, context);
  const std::vector<LinearPiece> pieces = differences(overlaid, metric);
  SeamPair pair;
  Sum area;
  for (std::size_t f = 0; f < overlaid.faces.size(); ++f)
    if (overlaid.parents[f][0] != none && overlaid.parents[f][1] != none)
      area.add(area_of(overlaid, overlaid.faces[f]));
  if (area.value() > 1e-10 * std::min(tile_area(a), tile_area(b))) {
    pair.overlap = true;
    describe(pieces, largest_height(near_a, near_b), pair);
    return pair;
  }
  if (pieces.empty() && !share_border(overlaid)) return std::nullopt;
  return pair;
}

std::vector<SeamJump> attribute_jumps(const CornerSurface& surface, const std::vector<Index>& contributors,
                                      const ContributorSets& sets, double z_tolerance, bool made_walls,
                                      const PlanMetric& metric, std::vector<SeamPair>& pairs) {
  PlanarMesh mesh{surface.points, surface.faces, {}, {}};
  connect(mesh);
  std::map<std::pair<int, int>, std::size_t> index;
  for (std::size_t i = 0; i < pairs.size(); ++i) index[std::minmax(pairs[i].a, pairs[i].b)] = i;
  struct Found {
    std::size_t pair;
    Point2 p, q;
    double dp, dq;
    bool f_is_b;
  };
  std::vector<Found> found;
  for (Index f = 0; f < static_cast<Index>(surface.faces.size()); ++f)
    for (int k = 0; k < 3; ++k) {
      const Index g = mesh.neighbours[f][k];
      if (g <= f || contributors[f] == contributors[g]) continue;
      int j = 0;
      while (surface.faces[g][(j + 1) % 3] != surface.faces[f][(k + 2) % 3]) ++j;
      const auto jump = [&](int in_f, int in_g) {
        const double z = surface.z[3 * static_cast<std::size_t>(f) + in_f % 3];
        const double d = z - surface.z[3 * static_cast<std::size_t>(g) + in_g % 3];
        return std::fabs(d) <= std::max(z_tolerance, rounding_jump(z)) ? 0 : d;
      };
      const double dp = jump(k + 1, j + 2), dq = jump(k + 2, j + 1);
      if (dp == 0 && dq == 0) continue;
      const auto who = responsible(sets.members(contributors[f]), sets.members(contributors[g]));
      const auto [it, fresh] = index.try_emplace(who, pairs.size());
      if (fresh) {
        pairs.emplace_back();
        pairs.back().a = who.first;
        pairs.back().b = who.second;
      }
      found.push_back({it->second, surface.points[surface.faces[f][(k + 1) % 3]],
                       surface.points[surface.faces[f][(k + 2) % 3]], dp, dq,
                       lies_on(sets.members(contributors[f]), sets.members(contributors[g]), pairs[it->second])});
    }
  std::vector<Jumps> jumps;
  for (SeamPair& pair : pairs) jumps.emplace_back(pair, metric);
  for (const Found& jump : found) jumps[jump.pair].add(jump.p, jump.q, jump.dp, jump.dq);
  for (Jumps& sums : jumps) sums.finish(made_walls);
  std::vector<SeamJump> listed;
  for (const Found& jump : found) {
    const double sign = jump.f_is_b ? 1 : -1;
    listed.push_back({pairs[jump.pair].a, pairs[jump.pair].b, jump.p, jump.q, sign * jump.dp, sign * jump.dq});
  }
  return listed;
}

}  // namespace terrane
