// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_face_base_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <limits>
#include <utility>

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
  Border(const Tin& tin, const PlanTopology& topology) : tin_(tin), topology_(topology) {}
  BorderReport examine(std::size_t limit);

 private:
  Index from(Index h) const { return topology_.place[topology_.from(tin_, h)]; }
  Index to(Index h) const { return topology_.place[topology_.to(tin_, h)]; }
  Point2 at(Index v) const { return plan(tin_.vertices[v]); }
  Vertex vertex(Index place) const {
    return vertices_[std::lower_bound(used_.begin(), used_.end(), place) - used_.begin()];
  }

  void insert_places();
  void insert_edges(BorderReport& report, std::size_t limit);
  void note_crossing(Index h, BorderReport& report, std::size_t limit) const;
  void trace_edges(BorderReport& report);
  std::pair<Triangle, int> first_piece(Vertex a, Vertex b) const;
  void wind();
  void collect_doubled(BorderReport& report, std::size_t limit);

  const Tin& tin_;
  const PlanTopology& topology_;
  std::vector<Index> used_;       // the places on the border, sorted
  std::vector<Vertex> vertices_;  // beside used_
  Triangulation cdt_;
};

void Border::insert_places() {
  for (const Index h : topology_.border) used_.push_back(from(h)), used_.push_back(to(h));
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
  for (const Index h : topology_.border) {
    try {
      cdt_.insert_constraint(vertex(from(h)), vertex(to(h)));
    } catch (const Triangulation::Intersection_of_constraints_exception&) {  // thrown before anything is changed
      ++report.crossings;
      note_crossing(h, report, limit);
    }
  }
}

void Border::note_crossing(Index h, BorderReport& report, std::size_t limit) const {
  const Point2 a = at(from(h)), b = at(to(h));
  for (const Index other : topology_.border) {
    if (report.crossing.size() >= limit) return;
    if (other >= h) return;  // only edges inserted before can have stopped this one
    const Point2 p = at(from(other)), q = at(to(other));
    if (orientation(a, b, p) * orientation(a, b, q) < 0 && orientation(p, q, a) * orientation(p, q, b) < 0)
      report.crossing.push_back({other, h});
  }
}

/// The edge of the triangulation that leaves a straight towards b, as (the triangle on its left, the corner opposite).
std::pair<Triangle, int> Border::first_piece(Vertex a, Vertex b) const {
  auto around = cdt_.incident_faces(a), end = around;
  do {
    const Triangle triangle = around;
    const int i = triangle->index(a);
    const Vertex c = triangle->vertex(Triangulation::ccw(i));  // a -> c has this triangle on its left
    if (cdt_.is_infinite(c)) continue;
    const int opposite = Triangulation::cw(i);
    if (c == b) return {triangle, opposite};
    if (!triangle->is_constrained(opposite)) continue;
    const Point2 p = at(used_[a->info()]), q = at(used_[b->info()]), r = at(used_[c->info()]);
    const bool forward = p.x != q.x ? (r.x > p.x) == (q.x > p.x) : (r.y > p.y) == (q.y > p.y);
    if (forward && orientation(p, q, r) == 0) return {triangle, opposite};
  } while (++around != end);
  return {Triangle(), 0};
}

/// Adds the flux of every border half-edge to the pieces it is made of, and notes the places between them.
void Border::trace_edges(BorderReport& report) {
  for (const Index h : topology_.border) {
    const Vertex last = vertex(to(h));
    for (Vertex v = vertex(from(h)); v != last;) {
      const auto [left, i] = first_piece(v, last);
      if (left == Triangle()) break;  // crosses another edge and was not inserted
      const Triangle right = left->neighbor(i);
      ++left->info().flux[i];
      --right->info().flux[right->index(left)];
      v = left->vertex(Triangulation::cw(i));
      if (v != last) report.touches.push_back({h, used_[v->info()]});
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
  trace_edges(report);
  if (report.crossings > 0) return report;
  wind();
  collect_doubled(report, limit);
  return report;
}

}  // namespace

BorderReport examine_border(const Tin& tin, const PlanTopology& topology, std::size_t limit) {
  return Border(tin, topology).examine(limit);
}

}  // namespace terrane
