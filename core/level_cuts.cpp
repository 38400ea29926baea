// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/level_cuts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/error.hpp"
#include "core/mosaic.hpp"
#include "core/predicates.hpp"
#include "core/shortest.hpp"
#include "core/surface/edge_cuts.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

constexpr std::size_t most_cuts = 50'000'000;
constexpr Index faces_per_report = 65536;

/// The cuts of one edge: consecutive vertices in their order along half-edge `half`.
struct Edge {
  Index half, first, count;
};

/// A point on the boundary of a face. Its rank is 2 * i + 1 on level i, 2 * i between levels i - 1 and i. Bits of
/// `lines` say which lines it lies on: 0 to 2 the sides, 3 and 4 the lower and the upper level of a piece, then
/// diagonals.
struct Node {
  Index vertex, rank;
  std::uint64_t lines;
};

/// A part of a face between two levels; whole, or a polygon of nodes_[first] to nodes_[last - 1].
struct Piece {
  Index face, zone;
  std::size_t first, last;
};

class Cutter {
 public:
  Cutter(CornerSurface surface, std::span<const double> levels) : surface_(std::move(surface)), levels_(levels) {
    mesh_.points = surface_.points;
    mesh_.faces = surface_.faces;
    first_made_ = static_cast<Index>(mesh_.points.size());
    connect(mesh_);
  }

  LevelPieces run(Context& context);

 private:
  double z(Index f, int corner) const { return surface_.z[3 * static_cast<std::size_t>(f) + corner % 3]; }
  Index rank_of(double height) const;
  void make_vertices(Context& context);
  void cut_edge(Index f, int k, Index g, int j);
  void make_vertex(Index p, Index q, double dp, double dq, Index level, Index level_of_twin, Index f, Index g);
  void split(Index f);
  void list_nodes(Index f, std::vector<Node>& nodes) const;
  void triangulate(std::vector<Node> polygon, int diagonals);
  bool cut_in_two(const std::vector<Node>& polygon, int diagonals);
  void emit(Index a, Index b, Index c);
  ExactPlace place(Index v) const;
  double distance(Index label, Point2 p) const;
  double steepest() const;

  CornerSurface surface_;
  std::span<const double> levels_;
  PlanarMesh mesh_;
  Index first_made_ = 0;
  std::vector<CutVertex> made_;
  std::vector<std::array<Index, 2>> level_;  // of a made vertex, as the two faces of its edge see it; none: no own cut
  std::vector<Index> edge_of_;               // half-edge -> edge with cuts
  std::vector<Edge> edges_;
  std::vector<Piece> pieces_;  // what the labels of the mesh stand for
  std::vector<Index> nodes_;
  Array<Point2> rounded_;          // as they were before any was moved
  std::array<Index, 2> target_{};  // the face that the next triangle replaces, or none; its label
};

Index Cutter::rank_of(double height) const {
  const auto at = std::lower_bound(levels_.begin(), levels_.end(), height);
  const auto i = static_cast<Index>(at - levels_.begin());
  return 2 * i + (at != levels_.end() && *at == height);
}

void Cutter::make_vertices(Context& context) {
  edge_of_.assign(3 * mesh_.faces.size(), none);
  for (Index f = 0; f < static_cast<Index>(mesh_.faces.size()); ++f) {
    if (f % faces_per_report == 0) context.progress("cut", 0.5 * f / mesh_.faces.size());
    for (int k = 0; k < 3; ++k) {
      const Index g = mesh_.neighbours[f][k];
      if (g != none && g < f) continue;
      int j = 0;
      if (g != none)
        while (mesh_.faces[g][(j + 1) % 3] != mesh_.faces[f][(k + 2) % 3]) ++j;
      cut_edge(f, k, g, j);
    }
  }
}

/// Cuts the edge opposite corner k of f, which is opposite corner j of g, at the levels that either face crosses there.
void Cutter::cut_edge(Index f, int k, Index g, int j) {
  struct Side {
    double zp, zq;
    Index at, end, step;  // levels still to be cut, in their order from p to q
  };
  const auto side = [&](double zp, double zq) {
    const auto low = std::upper_bound(levels_.begin(), levels_.end(), std::min(zp, zq)) - levels_.begin();
    const auto high = std::lower_bound(levels_.begin(), levels_.end(), std::max(zp, zq)) - levels_.begin();
    const Index first = static_cast<Index>(low), last = static_cast<Index>(std::max(low, high));
    return zp < zq ? Side{zp, zq, first, last, 1} : Side{zp, zq, last - 1, first - 1, -1};
  };
  Side a = side(z(f, k + 1), z(f, k + 2)), b = a;
  if (g == none)
    b.at = b.end;
  else if (z(g, j + 2) != a.zp || z(g, j + 1) != a.zq)
    b = side(z(g, j + 2), z(g, j + 1));
  if (a.at == a.end && b.at == b.end) return;

  const Index p = mesh_.faces[f][(k + 1) % 3], q = mesh_.faces[f][(k + 2) % 3];
  const auto to_p = [&](const Side& s) { return s.zp - levels_[s.at]; };
  const auto to_q = [&](const Side& s) { return s.zq - levels_[s.at]; };
  const Index first = static_cast<Index>(mesh_.points.size());
  while (a.at != a.end || b.at != b.end) {
    int order = a.at == a.end ? 1 : b.at == b.end ? -1 : 0;
    if (order == 0)
      order = compare_products(std::fabs(to_p(a)), std::fabs(to_q(b)), std::fabs(to_p(b)), std::fabs(to_q(a)));
    const Side& s = order <= 0 ? a : b;
    make_vertex(p, q, to_p(s), to_q(s), order <= 0 ? a.at : none, order >= 0 ? b.at : none, f, g);
    if (order <= 0) a.at += a.step;
    if (order >= 0) b.at += b.step;
  }
  if (made_.size() > most_cuts)
    throw Error(ErrorKind::input, "too-many-levels",
                "the surface crosses its levels more than 50 million times; use fewer levels, or simplify it first");
  const auto edge = static_cast<Index>(edges_.size());
  edges_.push_back({3 * f + k, first, static_cast<Index>(mesh_.points.size()) - first});
  edge_of_[3 * static_cast<std::size_t>(f) + k] = edge;
  if (g != none) edge_of_[3 * static_cast<std::size_t>(g) + j] = edge;
}

void Cutter::make_vertex(Index p, Index q, double dp, double dq, Index level, Index level_of_twin, Index f, Index g) {
  const Point2 a = mesh_.points[p], b = mesh_.points[q];
  if (b.x < a.x || (b.x == a.x && b.y < a.y)) std::swap(p, q), std::swap(dp, dq);
  made_.push_back({p, q, dp, dq, {level == none ? none : f, level_of_twin == none ? none : g}});
  level_.push_back({level, level_of_twin});
  mesh_.points.push_back(rounded(place(static_cast<Index>(mesh_.points.size()))));
}

ExactPlace Cutter::place(Index v) const {
  const CutVertex& made = made_[v - first_made_];
  ExactPlace place;
  place.kind = ExactPlace::ratio;
  place.p = mesh_.points[made.p];
  place.q = mesh_.points[made.q];
  place.dp = made.dp;
  place.dq = made.dq;
  return place;
}

/// The boundary of a face, counter-clockwise.
void Cutter::list_nodes(Index f, std::vector<Node>& nodes) const {
  for (int k = 0; k < 3; ++k) {
    const int side = (k + 2) % 3;
    const Index from = rank_of(z(f, k)), to = rank_of(z(f, k + 1));
    nodes.push_back({mesh_.faces[f][k], from, 7u & ~(1u << k)});
    const Index edge = edge_of_[3 * static_cast<std::size_t>(f) + side];
    if (edge == none) continue;
    const Edge& on = edges_[edge];
    const bool forwards = on.half == 3 * f + side;
    Index rank = from;  // between the level crossed last and the one to come
    if (rank % 2 == 1 && from != to) rank += from < to ? 1 : -1;
    for (Index i = 0; i < on.count; ++i) {
      const Index v = on.first + (forwards ? i : on.count - 1 - i);
      const Index level = level_[v - first_made_][forwards ? 0 : 1];
      nodes.push_back({v, level == none ? rank : 2 * level + 1, std::uint64_t{1} << side});
      if (level != none) rank = 2 * level + (from < to ? 2 : 0);
    }
  }
}

/// Divides a face along the levels that cross it and triangulates the pieces.
void Cutter::split(Index f) {
  const auto zone_of = [&](Index rank) { return (rank + 1) / 2; };  // of a level area: {z >= L}
  const auto edge = [&](int k) { return edge_of_[3 * static_cast<std::size_t>(f) + k]; };
  const Index rank[3] = {rank_of(z(f, 0)), rank_of(z(f, 1)), rank_of(z(f, 2))};
  const Index lowest = zone_of(std::min({rank[0], rank[1], rank[2]}));
  const Index highest = std::max(lowest, std::max({rank[0], rank[1], rank[2]}) / 2);
  if (edge(0) == none && edge(1) == none && edge(2) == none) {
    mesh_.labels[f] = static_cast<Index>(pieces_.size());
    pieces_.push_back({f, lowest, 0, 0});
    return;
  }
  std::vector<Node> nodes;
  list_nodes(f, nodes);
  std::vector<std::vector<Node>> polygons(highest - lowest + 1);
  for (const Node& n : nodes)
    for (Index zone = n.rank / 2; zone <= zone_of(n.rank); ++zone) {
      if (zone < lowest || zone > highest) continue;
      Node own = n;
      if (n.rank == 2 * zone - 1) own.lines |= 8u;
      if (n.rank == 2 * zone + 1) own.lines |= 16u;
      polygons[zone - lowest].push_back(own);
    }
  target_[0] = f;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    target_[1] = static_cast<Index>(pieces_.size());
    pieces_.push_back({f, lowest + static_cast<Index>(i), nodes_.size(), nodes_.size()});
    for (const Node& n : polygons[i]) nodes_.push_back(n.vertex);
    pieces_.back().last = nodes_.size();
    triangulate(std::move(polygons[i]), 5);
  }
}

double quality(Point2 p, Point2 q, Point2 r) {
  const auto square = [](Point2 u, Point2 v) { return (u.x - v.x) * (u.x - v.x) + (u.y - v.y) * (u.y - v.y); };
  const double longest = std::max({square(p, q), square(q, r), square(r, p)});
  return longest > 0 ? ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x)) / longest : 0;
}

/// Triangulates a convex polygon with collinear nodes. Whether nodes are collinear is known from the lines they lie on;
/// rounded places only choose between right answers. Bits from `diagonals` on are free.
void Cutter::triangulate(std::vector<Node> polygon, int diagonals) {
  if (polygon.size() > 8 && diagonals < 64 && cut_in_two(polygon, diagonals)) return;
  while (polygon.size() > 3) {  // ears, the best-shaped first
    const std::size_t n = polygon.size();
    std::size_t best = n;
    double best_quality = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Node &before = polygon[(i + n - 1) % n], &after = polygon[(i + 1) % n];
      if (before.lines & polygon[i].lines & after.lines) continue;
      std::uint64_t common = ~std::uint64_t{0};
      for (std::size_t k = 0; k < n; ++k)
        if (k != i) common &= polygon[k].lines;
      if (common != 0) continue;
      const double q =
          quality(mesh_.points[before.vertex], mesh_.points[polygon[i].vertex], mesh_.points[after.vertex]);
      if (best == n || q > best_quality) best = i, best_quality = q;
    }
    emit(polygon[(best + n - 1) % n].vertex, polygon[best].vertex, polygon[(best + 1) % n].vertex);
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(best));
  }
  emit(polygon[0].vertex, polygon[1].vertex, polygon[2].vertex);
}

/// Divides a large polygon along a diagonal, as evenly as one can; false when there is none.
bool Cutter::cut_in_two(const std::vector<Node>& polygon, int diagonals) {
  const std::size_t n = polygon.size();
  for (std::size_t step = n / 2; step >= 2; --step)
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t j = (i + step) % n;
      if (polygon[i].lines & polygon[j].lines) continue;
      const std::uint64_t diagonal = std::uint64_t{1} << diagonals;
      for (const auto& [from, to] : {std::pair(i, j), std::pair(j, i)}) {
        std::vector<Node> half;
        for (std::size_t k = from;; k = (k + 1) % n) {
          half.push_back(polygon[k]);
          if (k == to) break;
        }
        half.front().lines |= diagonal, half.back().lines |= diagonal;
        triangulate(std::move(half), diagonals + 1);
      }
      return true;
    }
  return false;
}

void Cutter::emit(Index a, Index b, Index c) {
  const Index f = std::exchange(target_[0], none);
  if (f != none) {
    mesh_.faces[f] = {a, b, c};
    mesh_.labels[f] = target_[1];
    return;
  }
  mesh_.faces.push_back({a, b, c});
  mesh_.labels.push_back(target_[1]);
}

/// How far p lies from a piece.
double Cutter::distance(Index label, Point2 p) const {
  const Piece& piece = pieces_[label];
  if (piece.first == piece.last) {
    const Face& c = surface_.faces[piece.face];
    return distance_to_triangle({rounded_[c[0]], rounded_[c[1]], rounded_[c[2]]}, p);
  }
  double least = std::numeric_limits<double>::infinity();
  bool inside = true;
  for (std::size_t i = piece.first; i < piece.last; ++i) {
    const Point2 a = rounded_[nodes_[i]], b = rounded_[nodes_[i + 1 == piece.last ? piece.first : i + 1]];
    double d;
    nearest_on_segment(a, b, p, d);
    least = std::min(least, d);
    inside = inside && orientation(a, b, p) >= 0;
  }
  return inside ? 0 : least;
}

/// The largest slope of a face that was cut.
double Cutter::steepest() const {
  double largest = 0;
  for (const CutVertex& made : made_)
    for (const Index f : made.owners) {
      if (f == none) continue;
      const Face& c = surface_.faces[f];
      largest = std::max(
          largest, slope_of_triangle({rounded_[c[0]], rounded_[c[1]], rounded_[c[2]]}, {z(f, 0), z(f, 1), z(f, 2)}));
    }
  return largest;
}

LevelPieces Cutter::run(Context& context) {
  const auto faces = static_cast<Index>(mesh_.faces.size());
  make_vertices(context);
  mesh_.labels.resize(faces);
  for (Index f = 0; f < faces; ++f) {
    if (f % faces_per_report == 0) context.progress("cut", 0.5 + 0.5 * f / faces);
    split(f);
  }
  LevelPieces result;
  rounded_ = mesh_.points;
  if (!made_.empty()) {
    const auto place_of = [&](Index v) { return place(v); };
    const auto from_piece = [&](Index label, Point2 p) { return distance(label, p); };
    result.rounding = round_cuts(mesh_, first_made_, place_of, from_piece, context).report;
    result.height_play = 2 * steepest() * result.rounding.max_move;
  }
  ZonedMesh& zoned = result.mesh;
  zoned.points = std::move(mesh_.points);
  zoned.faces = std::move(mesh_.faces);
  zoned.zone.reserve(mesh_.labels.size());
  result.parent.reserve(mesh_.labels.size());
  for (const Index label : mesh_.labels) {
    zoned.zone.push_back(pieces_[label].zone);
    result.parent.push_back(pieces_[label].face);
  }
  zoned.constructed.assign(zoned.points.size(), 0);
  std::fill(zoned.constructed.begin() + first_made_, zoned.constructed.end(), 1);
  result.surface = std::move(surface_);
  return result;
}

/// Levels the surface reaches must be as far apart as heights that stay apart, or their crossings might not.
void refuse_too_close(const std::vector<double>& z, std::span<const double> levels) {
  double low = INFINITY, high = -INFINITY;
  for (const double height : z) low = std::min(low, height), high = std::max(high, height);
  const double least = 1e-9 * std::max({1.0, std::fabs(low), std::fabs(high)});
  for (std::size_t i = 1; i < levels.size(); ++i)
    if (levels[i] >= low && levels[i - 1] <= high && !(levels[i] - levels[i - 1] >= least))
      throw Error(ErrorKind::input, "levels-too-close",
                  "levels " + shortest(levels[i - 1]) + " and " + shortest(levels[i]) +
                      " are closer to each other than heights of this surface can be told apart; leave one out, or use "
                      "a larger interval");
}

}  // namespace

LevelPieces level_pieces(CornerSurface surface, std::span<const double> levels, Context& context) {
  refuse_too_close(surface.z, levels);
  return Cutter(std::move(surface), levels).run(context);
}

LevelZones level_zones(const Tin& tin, std::span<const double> levels, Context& context) {
  LevelPieces pieces = level_pieces(piece_of(tin, 0).surface, levels, context);
  LevelZones result;
  result.rounding = pieces.rounding;
  result.height_play = pieces.height_play;
  result.mesh = dissolve(pieces.mesh, 4 * pieces.rounding.max_move, context);
  return result;
}

Tin flat_faces(const Tin& tin, std::span<const double> levels) {
  Tin flat{tin.vertices, {}};
  for (const Face& f : tin.faces) {
    const double z = tin.vertices[f[0]].z;
    if (tin.vertices[f[1]].z != z || tin.vertices[f[2]].z != z || is_wall(tin, f)) continue;
    if (std::binary_search(levels.begin(), levels.end(), z)) flat.faces.push_back(f);
  }
  return flat;
}

}  // namespace terrane
