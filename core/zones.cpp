// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/zones.hpp"

#include <algorithm>
#include <atomic>
#include <optional>
#include <random>
#include <tuple>
#include <utility>

#include "core/box.hpp"
#include "core/overlay.hpp"
#include "core/parallel.hpp"
#include "core/plan/region_fill.hpp"
#include "core/predicates.hpp"
#include "core/rounding/rounding.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

/// The border edges of all zones, and which of their points are needed.
class Borders {
 public:
  Borders(const ZonedMesh& mesh, double tolerance) : mesh_(mesh), tolerance_(tolerance), pieces_(pieces_of(mesh)) {
    note_beside();
    mark_needed();
  }

  /// Connected pieces of zones.
  const std::vector<Index>& zone_of_piece() const { return pieces_.zone_of_piece; }

  /// Every border edge, from one needed point to the next, the piece on its left as its tag.
  std::vector<BorderEdge> edges() const {
    std::vector<BorderEdge> edges;
    for_each_half_edge([&](Index f, Index, Index from, Index to, bool) {
      if (needed_[from]) edges.push_back({from, walk(from, to, [](Index) {}), pieces_.piece_of_face[f]});
    });
    return edges;
  }

  /// The border of the domain as it looks from outside.
  std::vector<BorderEdge> outside() const {
    std::vector<BorderEdge> edges;
    for_each_half_edge([&](Index, Index g, Index from, Index to, bool) {
      if (g == none && needed_[from]) edges.push_back({walk(from, to, [](Index) {}), from});
    });
    return edges;
  }

  /// Did a point go that did not lie exactly on the line between those that stayed?
  bool bent() const { return bent_; }

 private:
  /// Visits the half-edges on borders: the face, the face across, the ends, and whether it is the first of its edge.
  template <class Visit>
  void for_each_half_edge(Visit visit) const {
    for (Index f = 0; f < static_cast<Index>(mesh_.faces.size()); ++f)
      for (int k = 0; k < 3; ++k) {
        const Index g = pieces_.neighbours[f][k];
        if (g == none || mesh_.zone[g] != mesh_.zone[f])
          visit(f, g, mesh_.faces[f][(k + 1) % 3], mesh_.faces[f][(k + 2) % 3], g == none || f < g);
      }
  }

  /// The needed point that a border reaches from `from` over `to`, visiting those before it.
  template <class Visit>
  Index walk(Index from, Index to, Visit visit) const {
    while (!needed_[to]) {
      visit(to);
      const Index next = beside_[to][beside_[to][0] == from ? 1 : 0];
      from = std::exchange(to, next);
    }
    return to;
  }

  void note_beside() {
    beside_.assign(mesh_.points.size(), {none, none});
    std::vector<std::uint8_t> edges(mesh_.points.size(), 0);
    const auto note = [&](Index v, Index other) {
      if (edges[v] < 2) beside_[v][edges[v]] = other;
      if (edges[v] < 3) ++edges[v];
    };
    for_each_half_edge([&](Index, Index, Index from, Index to, bool first) {
      if (first) note(from, to), note(to, from);
    });
    needed_.assign(mesh_.points.size(), 1);
    for (std::size_t v = 0; v < mesh_.points.size(); ++v)
      if (edges[v] == 2 && may_go(static_cast<Index>(v), beside_[v][0], beside_[v][1])) needed_[v] = 0;
  }

  bool may_go(Index v, Index p, Index q) const {
    if (lies_on(v, p, q, 0)) return true;
    return !mesh_.constructed.empty() && mesh_.constructed[v] && lies_on(v, p, q, tolerance_);
  }

  /// Does v lie between p and q, within a distance of their line?
  bool lies_on(Index v, Index p, Index q, double distance) const {
    const Point2 a = mesh_.points[p], b = mesh_.points[q], at = mesh_.points[v];
    // No two border edges lie on each other: where three points are collinear, the one both have in common is between.
    if (orientation(a, b, at) == 0) return true;
    if (distance == 0) return false;
    double from_line;
    nearest_on_segment(a, b, at, from_line);
    return from_line <= distance;
  }

  /// So far each point that is not needed lies near the line through the points beside it; now near the line between
  /// those that stay. A row of them is halved until it does.
  void mark_needed() {
    std::vector<std::uint8_t> seen(mesh_.points.size(), 0);
    std::vector<std::vector<Index>> rows;
    for_each_half_edge([&](Index, Index, Index from, Index to, bool) {
      if (!needed_[from] || needed_[to] || seen[to]) return;
      std::vector<Index> row{from};
      row.push_back(walk(from, to, [&](Index v) { seen[v] = 1, row.push_back(v); }));
      rows.push_back(std::move(row));
    });
    for (std::size_t v = 0; v < needed_.size(); ++v)  // a ring no larger than the tolerance stays as it is
      if (!needed_[v] && !seen[v]) needed_[v] = 1;
    for (const auto& row : rows) straighten(row, 0, row.size() - 1);
  }

  void straighten(const std::vector<Index>& row, std::size_t first, std::size_t last) {
    bool straight = row[first] != row[last] || last == first + 1;
    for (std::size_t i = first + 1; straight && i < last; ++i)
      straight = lies_on(row[i], row[first], row[last], tolerance_);
    if (straight) {
      for (std::size_t i = first + 1; i < last; ++i) bent_ = bent_ || !lies_on(row[i], row[first], row[last], 0);
      return;
    }
    const std::size_t middle = (first + last) / 2;
    needed_[row[middle]] = 1;
    straighten(row, first, middle);
    straighten(row, middle, last);
  }

  const ZonedMesh& mesh_;
  double tolerance_;
  ZonePieces pieces_;
  std::vector<std::array<Index, 2>> beside_;  // where two border edges meet, their other ends
  std::vector<std::uint8_t> needed_;
  bool bent_ = false;
};

/// Border edges that belong together, one group after another.
struct Groups {
  std::vector<BorderEdge> edges;
  std::vector<std::size_t> first;
  std::span<const BorderEdge> group(std::size_t i) const { return {edges.data() + first[i], first[i + 1] - first[i]}; }
};

Groups grouped(const std::vector<BorderEdge>& edges, std::size_t groups) {
  Groups result;
  result.first.assign(groups + 1, 0);
  for (const BorderEdge& e : edges) ++result.first[e.tag + 1];
  for (std::size_t i = 0; i < groups; ++i) result.first[i + 1] += result.first[i];
  result.edges.resize(edges.size());
  std::vector<std::size_t> next = result.first;
  for (const BorderEdge& e : edges) result.edges[next[e.tag]++] = e;
  // In random order long edges side by side are put into a triangulation in O(n log^2 n); see Shewchuk & Brown (2015).
  std::mt19937 random;
  for (std::size_t g = 0; g < groups; ++g)
    for (std::size_t i = result.first[g + 1]; i > result.first[g] + 1; --i)
      std::swap(result.edges[i - 1], result.edges[result.first[g] + random() % (i - result.first[g])]);
  return result;
}

/// Does the border still bound the domain, seen from outside? The pieces inside are asked when they are filled.
bool bounds_outside(const ZonedMesh& mesh, std::vector<BorderEdge> outside) {
  Array<Point2> points = mesh.points;
  Box box = no_box;
  for (const Point2 p : points) box = around(box, p);
  box = frame_around(box);
  const auto n = static_cast<Index>(points.size());
  for (const Point2 corner :
       {Point2{box.xmin, box.ymin}, Point2{box.xmax, box.ymin}, Point2{box.xmax, box.ymax}, Point2{box.xmin, box.ymax}})
    points.push_back(corner);
  for (Index k = 0; k < 4; ++k) outside.push_back({n + k, n + (k + 1) % 4});
  return fill_region(points, outside).sound;
}

/// None where the points that are left out were needed to keep borders apart.
std::optional<ZonedMesh> triangulated_anew(const ZonedMesh& mesh, double tolerance, Context& context) {
  const Borders borders(mesh, tolerance);
  if (borders.bent() && !bounds_outside(mesh, borders.outside())) return {};
  const std::vector<Index>& zone_of_piece = borders.zone_of_piece();
  const Groups pieces = grouped(borders.edges(), zone_of_piece.size());
  std::vector<std::vector<Face>> faces(zone_of_piece.size());
  std::atomic<bool> sound = true;
  constexpr std::size_t pieces_per_task = 16;
  parallel_for(context, faces.size(), pieces_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && sound; ++i) {
      FilledRegion region = fill_region(mesh.points, pieces.group(i));
      if (!region.sound) sound = false;
      faces[i] = std::move(region.faces);
    }
  });
  if (!sound) return {};
  ZonedMesh result;
  std::vector<Index> index(mesh.points.size(), none);
  for (const BorderEdge& e : pieces.edges) index[e.from] = 0;
  for (std::size_t v = 0; v < index.size(); ++v)
    if (index[v] != none) {
      index[v] = static_cast<Index>(result.points.size());
      result.points.push_back(mesh.points[v]);
    }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (const Face& f : faces[i]) result.faces.push_back({index[f[0]], index[f[1]], index[f[2]]});
    result.zone.resize(result.faces.size(), zone_of_piece[i]);
  }
  return result;
}

Tin level_tin(const ZonedMesh& mesh) {
  Tin tin;
  tin.vertices.reserve(mesh.points.size());
  for (const Point2 p : mesh.points) tin.vertices.push_back({p.x, p.y, 0});
  tin.faces.assign(mesh.faces.begin(), mesh.faces.end());
  return tin;
}

/// 1 for the points that are no point of either input.
std::vector<std::uint8_t> crossings(const Array<Point2>& points, const ZonedMesh& a, const ZonedMesh& b) {
  const auto before = [](Point2 p, Point2 q) { return std::tie(p.x, p.y) < std::tie(q.x, q.y); };
  std::vector<Point2> given(a.points.begin(), a.points.end());
  given.insert(given.end(), b.points.begin(), b.points.end());
  std::sort(given.begin(), given.end(), before);
  std::vector<std::uint8_t> made(points.size());
  for (std::size_t v = 0; v < points.size(); ++v)
    made[v] = !std::binary_search(given.begin(), given.end(), points[v], before);
  return made;
}

}  // namespace

ZonePieces pieces_of(const ZonedMesh& mesh) {
  PlanarMesh planar{mesh.points, mesh.faces, {}, {}};
  connect(planar);
  ZonePieces pieces{std::move(planar.neighbours), {}, {}};
  pieces.piece_of_face.assign(mesh.faces.size(), none);
  std::vector<Index> stack;
  for (Index seed = 0; seed < static_cast<Index>(mesh.faces.size()); ++seed) {
    if (pieces.piece_of_face[seed] != none) continue;
    const auto piece = static_cast<Index>(pieces.zone_of_piece.size());
    pieces.zone_of_piece.push_back(mesh.zone[seed]);
    pieces.piece_of_face[seed] = piece;
    stack.push_back(seed);
    while (!stack.empty()) {
      const Index f = stack.back();
      stack.pop_back();
      for (const Index g : pieces.neighbours[f]) {
        if (g == none || pieces.piece_of_face[g] != none || mesh.zone[g] != mesh.zone[f]) continue;
        pieces.piece_of_face[g] = piece;
        stack.push_back(g);
      }
    }
  }
  return pieces;
}

ZonedMesh dissolve(const ZonedMesh& mesh, double tolerance, Context& context) {
  context.progress("dissolve", 0);
  if (mesh.faces.empty()) return {};
  for (const double within : {tolerance, 0.0}) {
    if (auto result = triangulated_anew(mesh, within, context)) return *std::move(result);
    context.progress("dissolve", 0.5);
  }
  return mesh;
}

ZonedMesh fold_zones(const ZonedMesh& a, const ZonedMesh& b, const ZoneFold& fold, RoundingReport& rounding,
                     Context& context) {
  Overlay both = overlay(level_tin(a), level_tin(b), {}, context);
  ZonedMesh folded;
  for (std::size_t f = 0; f < both.faces.size(); ++f) {
    const auto [in_a, in_b] = both.parents[f];
    const Index zone = fold(in_a == none ? none : a.zone[in_a], in_b == none ? none : b.zone[in_b]);
    if (zone == none) continue;
    folded.faces.push_back(both.faces[f]);
    folded.zone.push_back(zone);
  }
  folded.points = std::move(both.points);
  folded.constructed = crossings(folded.points, a, b);
  accumulate(rounding, both.rounding);
  return dissolve(folded, 4 * both.rounding.max_move, context);
}

Assembled lifted(const ZonedMesh& mesh, std::span<const double> heights, Context& context) {
  CornerSurface surface;
  surface.points = mesh.points;
  surface.faces = mesh.faces;
  surface.z.reserve(3 * mesh.faces.size());
  for (const Index zone : mesh.zone) surface.z.insert(surface.z.end(), 3, heights[zone]);
  return assemble(std::move(surface), {}, context);
}

}  // namespace terrane
