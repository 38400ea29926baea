// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_face_base_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "core/plan/insertion_order.hpp"
#include "core/predicates.hpp"
#include "core/topology.hpp"

namespace terrane {
namespace {

constexpr int unknown = std::numeric_limits<int>::min();

struct Region {
  int flux[3] = {
      0, 0, 0};  // border half-edges along the edge opposite corner i with this triangle on their left, minus right
  int winding = unknown;
  bool counted = false;
};

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Index, Kernel>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<Region, Kernel, CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                               CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Vertex = Triangulation::Vertex_handle;
using Triangle = Triangulation::Face_handle;

/// The border of a TIN in a triangulation of its places.
class Border {
 public:
  Border(const Tin& tin, std::span<const BorderHalfEdge> border) : tin_(tin), border_(border) {}
  BorderReport examine(std::size_t limit);

 private:
  Point2 at(Index v) const { return plan(tin_.vertices[v]); }
  Vertex vertex(Index place) const {
    return vertices_[std::lower_bound(used_.begin(), used_.end(), place) - used_.begin()];
  }

  void insert_places();
  void insert_edges(BorderReport& report, std::size_t limit);
  void note_crossing(const BorderHalfEdge& edge, BorderReport& report, std::size_t limit) const;
  void trace_edges(BorderReport& report);
  /// A directed constrained edge of the triangulation, by the numbers of its ends in used_.
  struct Piece {
    Index from, to;
    Triangle left;  // the triangle on its left, and the corner opposite the edge there
    int opposite;
    std::pair<Index, Index> ends() const { return {from, to}; }
  };
  void list_pieces();
  const Piece* first_piece(Index a, Index b) const;
  void wind();
  void collect_doubled(BorderReport& report, std::size_t limit);

  const Tin& tin_;
  std::span<const BorderHalfEdge> border_;
  std::vector<Index> used_;       // the places on the border, sorted
  std::vector<Vertex> vertices_;  // beside used_
  Triangulation cdt_;
  std::vector<Piece> pieces_;  // by their ends
};

void Border::insert_places() {
  for (const BorderHalfEdge& e : border_) used_.push_back(e.from), used_.push_back(e.to);
  std::sort(used_.begin(), used_.end());
  used_.erase(std::unique(used_.begin(), used_.end()), used_.end());
  std::vector<std::pair<Kernel::Point_2, Index>> points;
  points.reserve(used_.size());
  for (std::size_t i = 0; i < used_.size(); ++i)
    points.emplace_back(Kernel::Point_2(at(used_[i]).x, at(used_[i]).y), static_cast<Index>(i));
  cdt_.insert(points.begin(), points.end());
  vertices_.resize(used_.size());
  for (auto v = cdt_.finite_vertices_begin(); v != cdt_.finite_vertices_end(); ++v) vertices_[v->info()] = v;
}

void Border::insert_edges(BorderReport& report, std::size_t limit) {
  // CGAL looks at every neighbour of the vertex that a constraint starts from: at a hub that would be quadratic.
  std::vector<Index> degree(used_.size(), 0);
  for (const BorderHalfEdge& e : border_) ++degree[vertex(e.from)->info()], ++degree[vertex(e.to)->info()];
  std::vector<BorderHalfEdge> order(border_.begin(), border_.end());
  order_for_insertion(order);
  for (const BorderHalfEdge& e : order) {
    Vertex a = vertex(e.from), b = vertex(e.to);
    if (degree[a->info()] > degree[b->info()]) std::swap(a, b);
    try {
      cdt_.insert_constraint(a, b);
    } catch (const Triangulation::Intersection_of_constraints_exception&) {  // thrown before anything is changed
      ++report.crossings;
      note_crossing(e, report, limit);
    }
  }
}

void Border::note_crossing(const BorderHalfEdge& edge, BorderReport& report, std::size_t limit) const {
  const Point2 a = at(edge.from), b = at(edge.to);
  for (const BorderHalfEdge& other : border_) {
    if (report.crossing.size() >= limit) return;
    const Point2 p = at(other.from), q = at(other.to);
    if (orientation(a, b, p) * orientation(a, b, q) < 0 && orientation(p, q, a) * orientation(p, q, b) < 0)
      report.crossing.push_back({other.half_edge, edge.half_edge});
  }
}

void Border::list_pieces() {
  for (auto edge = cdt_.constrained_edges_begin(); edge != cdt_.constrained_edges_end(); ++edge) {
    const auto& [triangle, i] = *edge;
    const Index a = triangle->vertex(Triangulation::ccw(i))->info(), b = triangle->vertex(Triangulation::cw(i))->info();
    pieces_.push_back({a, b, triangle, i});
    pieces_.push_back({b, a, triangle->neighbor(i), triangle->neighbor(i)->index(triangle)});
  }
  std::sort(pieces_.begin(), pieces_.end(), [](const Piece& p, const Piece& q) { return p.ends() < q.ends(); });
}

/// The constrained edge that leaves a straight towards b.
const Border::Piece* Border::first_piece(Index a, Index b) const {
  const auto from_a = [&](Index to) {
    const std::pair<Index, Index> ends = {a, to};
    return std::partition_point(pieces_.begin(), pieces_.end(), [&](const Piece& p) { return p.ends() < ends; });
  };
  const auto whole = from_a(b);
  if (whole != pieces_.end() && whole->ends() == std::pair(a, b)) return &*whole;
  const Point2 p = at(used_[a]), q = at(used_[b]);
  for (auto piece = from_a(0); piece != pieces_.end() && piece->from == a; ++piece) {
    const Point2 r = at(used_[piece->to]);
    const bool forward =
        p.x != q.x ? (r.x > p.x) == (q.x > p.x) && r.x != p.x : (r.y > p.y) == (q.y > p.y) && r.y != p.y;
    if (forward && orientation(p, q, r) == 0) return &*piece;
  }
  return nullptr;
}

/// Adds the flux of every border half-edge to the pieces it is made of, and notes the places between them.
void Border::trace_edges(BorderReport& report) {
  for (const BorderHalfEdge& e : border_) {
    const Index last = vertex(e.to)->info();
    for (Index v = vertex(e.from)->info(); v != last;) {
      const Piece* piece = first_piece(v, last);
      if (!piece) break;  // crosses another edge and was not inserted
      const Triangle right = piece->left->neighbor(piece->opposite);
      ++piece->left->info().flux[piece->opposite];
      --right->info().flux[right->index(piece->left)];
      v = piece->to;
      if (v != last) report.touches.push_back({e.half_edge, used_[v]});
    }
  }
}

void Border::wind() {
  std::vector<Triangle> stack = {cdt_.infinite_face()};
  stack.back()->info().winding = 0;
  while (!stack.empty()) {
    const Triangle t = stack.back();
    stack.pop_back();
    for (int i = 0; i < 3; ++i) {
      const Triangle n = t->neighbor(i);
      if (n->info().winding != unknown) continue;
      n->info().winding = t->info().winding - t->info().flux[i];
      stack.push_back(n);
    }
  }
}

void Border::collect_doubled(BorderReport& report, std::size_t limit) {
  const auto doubled = [](Triangle t) { return t->info().winding != 0 && t->info().winding != 1; };
  std::vector<Triangle> stack;
  for (auto seed = cdt_.finite_faces_begin(); seed != cdt_.finite_faces_end(); ++seed) {
    if (!doubled(seed) || seed->info().counted) continue;
    ++report.doubled_regions;
    seed->info().counted = true;
    stack.assign(1, seed);
    while (!stack.empty()) {
      const Triangle t = stack.back();
      stack.pop_back();
      if (report.doubled.size() < limit)
        report.doubled.push_back(
            {at(used_[t->vertex(0)->info()]), at(used_[t->vertex(1)->info()]), at(used_[t->vertex(2)->info()])});
      for (int i = 0; i < 3; ++i) {
        const Triangle n = t->neighbor(i);
        if (cdt_.is_infinite(n) || !doubled(n) || n->info().counted) continue;
        n->info().counted = true;
        stack.push_back(n);
      }
    }
  }
}

BorderReport Border::examine(std::size_t limit) {
  BorderReport report;
  insert_places();
  if (cdt_.dimension() < 2) return report;
  insert_edges(report, limit);
  list_pieces();
  trace_edges(report);
  if (report.crossings > 0) return report;
  wind();
  collect_doubled(report, limit);
  return report;
}

}  // namespace

BorderReport examine_border(const Tin& tin, std::span<const BorderHalfEdge> border, std::size_t limit) {
  return Border(tin, border).examine(limit);
}

}  // namespace terrane
