// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/plan_region.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_face_base_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "core/error.hpp"
#include "core/plan/noding.hpp"
#include "core/plan/region_fill.hpp"
#include "core/predicates.hpp"
#include "core/validate.hpp"

namespace terrane {
namespace {

struct Ring {
  Index polygon;
  bool hole;
};

/// The rings of all polygons as edges; owners are rings.
class Collector {
 public:
  void add(const Line& line, Index polygon, bool hole) {
    const Index first = static_cast<Index>(points.size()), owner = static_cast<Index>(rings.size());
    for (std::size_t i = 0; i < line.size(); ++i) {
      check(line[i], polygon, i);
      points.push_back({line[i].x + 0.0, line[i].y + 0.0});  // -0 and 0 are one place
    }
    const Index n = static_cast<Index>(line.size());
    for (Index i = 0; i < n; ++i)
      if (const Index next = (i + 1) % n; !(points[first + i] == points[first + next]))
        edges.push_back({first + i, first + next, owner});
    rings.push_back({polygon, hole});
  }

  std::vector<Point2> points;
  std::vector<NodedEdge> edges;
  std::vector<Ring> rings;

 private:
  static void check(const Point& p, Index polygon, std::size_t corner) {
    if (std::fabs(p.x) <= largest_coordinate && std::fabs(p.y) <= largest_coordinate) return;
    throw Error(ErrorKind::input, "not-finite",
                "corner " + std::to_string(corner) + " of polygon " + std::to_string(polygon) +
                    " has a coordinate that is not a finite number, or beyond 1e100");
  }
};

/// An edge between two places, and the rings that pass along it an odd number of times.
struct Wall {
  Index low, high;
  std::vector<Index> rings;
};

std::vector<Wall> walls_of(const std::vector<NodedEdge>& edges) {
  std::vector<std::array<Index, 3>> sorted;
  for (const NodedEdge& e : edges) sorted.push_back({std::min(e.from, e.to), std::max(e.from, e.to), e.owner});
  std::sort(sorted.begin(), sorted.end());
  std::vector<Wall> walls;
  for (std::size_t i = 0; i < sorted.size();) {
    std::size_t j = i;
    while (j < sorted.size() && sorted[j] == sorted[i]) ++j;
    if ((j - i) % 2 == 1) {
      const auto& [low, high, ring] = sorted[i];
      if (walls.empty() || walls.back().low != low || walls.back().high != high) walls.push_back({low, high, {}});
      walls.back().rings.push_back(ring);
    }
    i = j;
  }
  return walls;
}

/// Which rings a place is inside of while one goes from face to face.
class Cover {
 public:
  explicit Cover(const std::vector<Ring>& rings) : rings_(rings), inside_(rings.size(), false) {
    for (const Ring& r : rings)
      if (const auto count = static_cast<std::size_t>(r.polygon) + 1; polygons_.size() < count) polygons_.resize(count);
  }

  void cross(const Wall& wall) {
    for (const Index ring : wall.rings) {
      State& polygon = polygons_[rings_[ring].polygon];
      covering_ -= polygon.covers();
      inside_[ring] = !inside_[ring];
      if (rings_[ring].hole)
        polygon.holes += inside_[ring] ? 1 : -1;
      else
        polygon.outer = inside_[ring];
      covering_ += polygon.covers();
    }
  }
  bool covered() const { return covering_ > 0; }

 private:
  struct State {
    bool outer = false;
    Index holes = 0;
    int covers() const { return outer && holes == 0; }
  };
  const std::vector<Ring>& rings_;
  std::vector<bool> inside_;
  std::vector<State> polygons_;
  int covering_ = 0;
};

struct FaceInfo {
  std::array<Index, 3> wall = {none, none, none};  // opposite each corner
  bool seen = false, covered = false;
};
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Index, Kernel>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<FaceInfo, Kernel, CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                               CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Triangle = Triangulation::Face_handle;

/// A triangulation with every wall among its edges. Walls meet at their ends only, so none is ever cut.
void build(const std::vector<Point2>& points, const std::vector<Wall>& walls, Triangulation& triangulation) {
  std::vector<std::pair<Kernel::Point_2, Index>> all;
  std::vector<std::uint8_t> used(points.size(), 0);
  for (const Wall& w : walls) used[w.low] = used[w.high] = 1;
  for (std::size_t v = 0; v < points.size(); ++v)
    if (used[v]) all.emplace_back(Kernel::Point_2(points[v].x, points[v].y), static_cast<Index>(v));
  triangulation.insert(all.begin(), all.end());
  std::vector<Triangulation::Vertex_handle> vertex(points.size());
  for (auto v = triangulation.finite_vertices_begin(); v != triangulation.finite_vertices_end(); ++v)
    vertex[v->info()] = v;
  for (const Wall& w : walls) triangulation.insert_constraint(vertex[w.low], vertex[w.high]);
  for (std::size_t i = 0; i < walls.size(); ++i) {
    Triangle f;
    int k;
    if (!triangulation.is_edge(vertex[walls[i].low], vertex[walls[i].high], f, k))
      throw Error(ErrorKind::internal, "region", "an edge of a region is none of its triangulation");
    f->info().wall[k] = static_cast<Index>(i);
    f->neighbor(k)->info().wall[triangulation.mirror_index(f, k)] = static_cast<Index>(i);
  }
}

/// Marks what is covered: from outside over every edge, and back on the same way, so that one state is enough.
void flood(Triangulation& triangulation, const std::vector<Wall>& walls, Cover& cover) {
  struct Step {
    Triangle face;
    int next;
    Index over;
  };
  std::vector<Step> way;
  const auto enter = [&](Triangle f, Index over) {
    if (over != none) cover.cross(walls[over]);
    f->info().seen = true;
    f->info().covered = cover.covered();
    way.push_back({f, 0, over});
  };
  enter(triangulation.infinite_face(), none);
  while (!way.empty()) {
    Step& here = way.back();
    if (here.next == 3) {
      if (here.over != none) cover.cross(walls[here.over]);
      way.pop_back();
      continue;
    }
    const int k = here.next++;
    const Triangle beyond = here.face->neighbor(k);
    if (!beyond->info().seen) enter(beyond, here.face->info().wall[k]);
  }
}

/// Edges between what is covered and what is not, the former on the left.
std::vector<BorderEdge> border_of(Triangulation& triangulation) {
  std::vector<BorderEdge> border;
  for (auto f = triangulation.finite_faces_begin(); f != triangulation.finite_faces_end(); ++f)
    for (int k = 0; f->info().covered && k < 3; ++k)
      if (!f->neighbor(k)->info().covered)
        border.push_back({f->vertex(Triangulation::ccw(k))->info(), f->vertex(Triangulation::cw(k))->info()});
  std::sort(border.begin(), border.end(),
            [](const BorderEdge& e, const BorderEdge& g) { return std::tie(e.from, e.to) < std::tie(g.from, g.to); });
  return border;
}

PlanRegion filled(const std::vector<Point2>& points, const std::vector<BorderEdge>& border) {
  PlanRegion region;
  if (border.empty()) return region;
  const FilledRegion fill = fill_region(points, border);
  if (!fill.sound) throw Error(ErrorKind::internal, "region", "the border of a region does not close");
  for (const BorderEdge& e : border) region.border.push_back({points[e.from], points[e.to]});
  Tin tin;
  for (const Point2& p : points) tin.vertices.push_back({p.x, p.y, 0});
  tin.faces = fill.faces;
  region.tin = canonical(std::move(tin));
  return region;
}

/// Where edges of one polygon meet, but for corners that touch: ends that lie on each other or inside another edge are
/// in order, edges that cross or run along each other are not.
std::optional<Point2> self_crossing(const Collector& rings, const Context& context) {
  const std::span<const NodedEdge> all(rings.edges);
  const auto polygon = [&](std::size_t e) { return rings.rings[all[e].owner].polygon; };
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && polygon(end) == polygon(begin)) ++end;
    const std::span<const NodedEdge> own = all.subspan(begin, end - begin);
    for (const Crossing& c : find_crossings(rings.points, own, static_cast<std::size_t>(-1), context)) {
      const NodedEdge &a = own[c.a], &b = own[c.b];
      bool touches = false;
      for (const Index v : {a.from, a.to, b.from, b.to}) touches = touches || rings.points[v] == c.at;
      if (!touches) return c.at;
    }
  }
  return {};
}

}  // namespace

PlanRegion plan_region(std::span<const Polygon> polygons, const Context& context) {
  Collector rings;
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    rings.add(polygons[p].outer, static_cast<Index>(p), false);
    for (const Line& hole : polygons[p].holes) rings.add(hole, static_cast<Index>(p), true);
  }
  const std::optional<Point2> crossing = self_crossing(rings, context);
  const Noded noded = node_edges(std::move(rings.points), std::move(rings.edges), context);
  const std::vector<Wall> walls = walls_of(noded.edges);
  PlanRegion region;
  if (!walls.empty()) {
    Triangulation triangulation;
    build(noded.points, walls, triangulation);
    Cover cover(rings.rings);
    if (triangulation.dimension() == 2) {
      flood(triangulation, walls, cover);
      region = filled(noded.points, border_of(triangulation));
    }
  }
  region.self_crossing = crossing;
  return region;
}

PlanRegion plan_region(const Box& box) {
  const std::vector<Point2> corners = {
      {box.xmin, box.ymin}, {box.xmax, box.ymin}, {box.xmax, box.ymax}, {box.xmin, box.ymax}};
  return filled(corners, {{0, 1}, {1, 2}, {2, 3}, {3, 0}});
}

int side_of(const PlanRegion& region, Point2 place) {
  bool inside = false;
  for (const auto& [p, q] : region.border) {
    const bool below_p = p.y <= place.y, below_q = q.y <= place.y;
    const bool beside = std::min(p.x, q.x) <= place.x && place.x <= std::max(p.x, q.x) &&
                        std::min(p.y, q.y) <= place.y && place.y <= std::max(p.y, q.y);
    if (below_p == below_q && !beside) continue;
    const int turn = orientation(p, q, place);
    if (turn == 0 && beside) return 0;
    if (below_p != below_q && (turn > 0) == below_p) inside = !inside;
  }
  return inside ? 1 : -1;
}

}  // namespace terrane
