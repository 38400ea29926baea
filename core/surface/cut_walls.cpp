// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/surface/cut_walls.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "core/plan/place_order.hpp"
#include "core/predicates.hpp"
#include "core/rounding/rounding.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

/// A segment in plan, from the end lower in x, then y.
struct Segment {
  Point2 low, high;
  bool operator<(const Segment& s) const {
    return std::tie(low.x, low.y, high.x, high.y) < std::tie(s.low.x, s.low.y, s.high.x, s.high.y);
  }
};
Segment segment(Point2 p, Point2 q) { return before(p, q) ? Segment{p, q} : Segment{q, p}; }

/// What stands along a segment: places from the lower end to the higher one, and of the piece that begins at each on
/// which sides of the border the faces beside it lie.
struct Row {
  std::vector<std::pair<Index, Point2>> places;  // of the overlay, or none
  std::vector<std::uint8_t> beside;              // 1 outside, 2 inside, 3 both; 0 nobody knows
};

/// A wall: two corners on one vertical line and the third elsewhere, turned so.
struct WallFace {
  std::array<Index, 3> corner;
};

std::optional<WallFace> wall_face(const Tin& tin, const Face& f) {
  for (int k = 0; k < 3; ++k) {
    const Point2 a = plan(tin.vertices[f[k]]), b = plan(tin.vertices[f[(k + 1) % 3]]);
    if (a == b && !(plan(tin.vertices[f[(k + 2) % 3]]) == a)) return WallFace{{f[k], f[(k + 1) % 3], f[(k + 2) % 3]}};
  }
  return {};
}

class WallCutter {
 public:
  WallCutter(const CutSurface& cut, bool inside, const VertexAt& vertex_at, std::vector<Face>& faces)
      : cut_(cut), inside_(inside), vertex_at_(vertex_at), faces_(faces) {}

  std::size_t run() {
    for (const Index w : cut_.walls)
      if (const auto wall = wall_face(cut_.surface, cut_.surface.faces[w])) rows_[segment_of(*wall)];
    follow_edges();
    std::size_t divided = 0;
    for (const Index w : cut_.walls) {
      const auto wall = wall_face(cut_.surface, cut_.surface.faces[w]);
      if (!wall) continue;
      Row& row = rows_[segment_of(*wall)];
      if (row.places.empty()) row = alone(segment_of(*wall));
      divided += emit(*wall, row);
    }
    return divided;
  }

 private:
  Point2 at(Index vertex) const { return plan(cut_.surface.vertices[vertex]); }
  Segment segment_of(const WallFace& wall) const { return segment(at(wall.corner[0]), at(wall.corner[2])); }

  /// Finds the rows of segments that are edges of faces: the pieces of a face have its outline.
  void follow_edges() {
    const Tin& tin = cut_.surface;
    std::vector<std::uint8_t> wanted(cut_.faces.size(), 0);  // bit k: edge from corner k has a wall
    for (std::size_t f = 0; f < cut_.faces.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        const Face& face = tin.faces[cut_.faces[f]];
        if (rows_.count(segment(at(face[k]), at(face[(k + 1) % 3])))) wanted[f] |= 1 << k;
      }
    struct Edge {
      Index parent, from, to;
      std::uint8_t side;
    };
    std::vector<Edge> edges;
    for (std::size_t p = 0; p < cut_.overlay.faces.size(); ++p) {
      const auto [parent, inside] = cut_.overlay.parents[p];
      if (parent == none || !wanted[parent]) continue;
      const Face& face = cut_.overlay.faces[p];
      for (int k = 0; k < 3; ++k)
        edges.push_back({parent, face[k], face[(k + 1) % 3], static_cast<std::uint8_t>(inside == none ? 1 : 2)});
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& g) {
      return std::tie(e.parent, e.from, e.to) < std::tie(g.parent, g.from, g.to);
    });
    for (std::size_t i = 0; i < edges.size();) {
      std::size_t j = i;
      std::map<std::pair<Index, Index>, std::uint8_t> own;
      for (; j < edges.size() && edges[j].parent == edges[i].parent; ++j)
        own[{edges[j].from, edges[j].to}] = edges[j].side;
      std::map<Index, std::pair<Index, std::uint8_t>> outline;
      for (const auto& [ends, side] : own)
        if (!own.count({ends.second, ends.first})) outline[ends.first] = {ends.second, side};
      const Face& face = tin.faces[cut_.faces[edges[i].parent]];
      for (int k = 0; k < 3; ++k)
        if (wanted[edges[i].parent] >> k & 1) follow(outline, at(face[k]), at(face[(k + 1) % 3]));
      i = j;
    }
  }

  /// Joins what one face says of the segment from p to q to what another may have said.
  void follow(const std::map<Index, std::pair<Index, std::uint8_t>>& outline, Point2 p, Point2 q) {
    const auto point = [&](Index v) { return cut_.overlay.points[v]; };
    auto it = std::find_if(outline.begin(), outline.end(), [&](const auto& e) { return point(e.first) == p; });
    Row row;
    while (it != outline.end() && row.places.size() <= outline.size()) {
      row.places.emplace_back(it->first, point(it->first));
      row.beside.push_back(it->second.second);
      const Index next = it->second.first;
      if (point(next) == q) {
        row.places.emplace_back(next, q);
        break;
      }
      it = outline.find(next);
    }
    if (row.places.size() != row.beside.size() + 1) return;  // mended beyond recognition
    if (before(q, p))
      std::reverse(row.places.begin(), row.places.end()), std::reverse(row.beside.begin(), row.beside.end());
    Row& known = rows_[segment(p, q)];
    if (known.places.empty())
      known = row;
    else if (known.places == row.places)
      for (std::size_t i = 0; i < row.beside.size(); ++i) known.beside[i] |= row.beside[i];
  }

  /// The row of a wall that no face stands beside.
  Row alone(const Segment& s) const {
    std::vector<Point2> cuts{s.low, s.high};
    for (const auto& [p, q] : cut_.region.border) {
      const int u = orientation(s.low, s.high, p), v = orientation(s.low, s.high, q);
      if (u * v > 0) continue;
      const auto between = [&](Point2 c) { return before(s.low, c) && before(c, s.high); };
      if (u == 0 && between(p)) cuts.push_back(p);
      if (v == 0 && between(q)) cuts.push_back(q);
      if (u * v < 0 && orientation(p, q, s.low) * orientation(p, q, s.high) < 0)
        cuts.push_back(rounded({ExactPlace::crossing, s.low, s.high, p, q}));
    }
    std::sort(cuts.begin(), cuts.end(),
              [&](Point2 p, Point2 q) { return fraction_along(s.low, s.high, p) < fraction_along(s.low, s.high, q); });
    cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
    Row row;
    for (const Point2 p : cuts) row.places.emplace_back(none, p);
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      const int side = side_of(cut_.region, {0.5 * (cuts[i].x + cuts[i + 1].x), 0.5 * (cuts[i].y + cuts[i + 1].y)});
      row.beside.push_back(side > 0 ? 2 : side < 0 ? 1 : 3);
    }
    return row;
  }

  /// The parts of a wall on the wanted side; returns whether some are on each side.
  bool emit(const WallFace& wall, const Row& row) {
    const bool turned = at(wall.corner[0]) == row.places.back().second;
    const std::size_t n = row.beside.size();
    std::uint8_t sides = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t piece = turned ? n - 1 - i : i;
      sides |= row.beside[piece] == 3 ? 0 : row.beside[piece];
      if (row.beside[piece] != (inside_ ? 2 : 1)) continue;
      const auto& from = row.places[turned ? piece + 1 : piece];
      const auto& to = row.places[turned ? piece : piece + 1];
      const Index a0 = corner(wall, 0, from, i == 0, false), b0 = corner(wall, 1, from, i == 0, false);
      const Index a1 = corner(wall, 0, to, false, i == n - 1), b1 = corner(wall, 1, to, false, i == n - 1);
      add({a0, b0, b1});
      add({a0, b1, a1});
    }
    return sides == 3;
  }

  void add(const Face& f) {
    if (f[0] != f[1] && f[1] != f[2] && f[2] != f[0]) faces_.push_back(f);
  }

  /// The vertex of the edge from corner `which` to the tip at a place of the row.
  Index corner(const WallFace& wall, int which, const std::pair<Index, Point2>& place, bool first, bool last) const {
    if (first) return wall.corner[which];
    if (last) return wall.corner[2];
    // From the lower end, as the faces beside it have it: the same height to the last bit.
    Point p = cut_.surface.vertices[wall.corner[which]], q = cut_.surface.vertices[wall.corner[2]];
    if (before(plan(q), plan(p))) std::swap(p, q);
    return vertex_at_(place.first, place.second, mix(p.z, q.z, fraction_along(plan(p), plan(q), place.second)));
  }

  const CutSurface& cut_;
  bool inside_;
  const VertexAt& vertex_at_;
  std::vector<Face>& faces_;
  std::map<Segment, Row> rows_;
};

}  // namespace

std::size_t cut_walls(const CutSurface& cut, bool inside, const VertexAt& vertex_at, std::vector<Face>& faces) {
  return WallCutter(cut, inside, vertex_at, faces).run();
}

}  // namespace terrane
