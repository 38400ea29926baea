// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/plan/filled_ring.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/box.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Index, Kernel>;
using FaceBase =
    CGAL::Constrained_triangulation_face_base_2<Kernel, CGAL::Triangulation_face_base_with_info_2<bool, Kernel>>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                               CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Vertex = Triangulation::Vertex_handle;

class RingFiller {
 public:
  RingFiller(std::span<const Point2> ring, double max_edge, const Context& context)
      : ring_(ring), max_edge_(max_edge), context_(context) {}

  PlainMesh run() {
    insert_ring();
    if (triangulation_.dimension() < 2) return {};
    if (max_edge_ > 0) {
      insert_lattice();
      while (halve_long_edges()) context_.stop_if_cancelled();
    }
    find_inside();
    return mesh();
  }

 private:
  static Point2 at(Vertex v) { return {v->point().x(), v->point().y()}; }
  static double length(Vertex v, Vertex w) { return std::hypot(at(w).x - at(v).x, at(w).y - at(v).y); }

  void insert_ring() {
    std::vector<std::pair<Kernel::Point_2, Index>> points;
    for (std::size_t i = 0; i < ring_.size(); ++i)
      points.emplace_back(Kernel::Point_2(ring_[i].x, ring_[i].y), static_cast<Index>(i));
    triangulation_.insert(points.begin(), points.end());
    std::vector<Vertex> vertex(ring_.size());
    for (auto v = triangulation_.finite_vertices_begin(); v != triangulation_.finite_vertices_end(); ++v)
      vertex[v->info()] = v;
    if (triangulation_.dimension() < 2) return;
    for (std::size_t i = 0; i < ring_.size(); ++i)
      triangulation_.insert_constraint(vertex[i], vertex[(i + 1) % ring_.size()]);
  }

  /// Every face is inside but those that can be reached from the infinite ones without crossing the ring.
  void find_inside() {
    std::vector<Triangulation::Face_handle> stack;
    for (auto f = triangulation_.all_faces_begin(); f != triangulation_.all_faces_end(); ++f) f->info() = true;
    const auto leave = [&](Triangulation::Face_handle f) {
      f->info() = false;
      stack.push_back(f);
    };
    leave(triangulation_.infinite_face());
    while (!stack.empty()) {
      const auto f = stack.back();
      stack.pop_back();
      for (int k = 0; k < 3; ++k)
        if (!f->is_constrained(k) && f->neighbor(k)->info()) leave(f->neighbor(k));
    }
  }

  /// Places of a lattice of equilateral triangles that lie inside, and not so near the ring that thin faces would come
  /// of it.
  void insert_lattice() {
    find_inside();
    Box box = no_box;
    for (const Point2 p : ring_) box = around(box, p);
    const double step = 0.8 * max_edge_, rise = step * std::sqrt(0.75), apart = 0.5 * step;
    const double columns = std::floor((box.xmax - box.xmin) / step), rows = std::floor((box.ymax - box.ymin) / rise);
    const double x0 = 0.5 * (box.xmin + box.xmax - columns * step), y0 = 0.5 * (box.ymin + box.ymax - rows * rise);
    mark_ring(box, apart);
    std::vector<Kernel::Point_2> lattice;
    Triangulation::Face_handle hint;
    for (int j = 0; j <= static_cast<int>(rows); ++j) {
      context_.stop_if_cancelled();
      for (int i = 0; i <= static_cast<int>(columns); ++i) {
        const Point2 p{x0 + (i + (j % 2 == 0 ? 0.0 : 0.5)) * step, y0 + j * rise};
        if (near_ring(p, apart)) continue;
        Triangulation::Locate_type type;
        int k;
        const Kernel::Point_2 place(p.x, p.y);
        hint = triangulation_.locate(place, type, k, hint);
        const bool inside = type == Triangulation::FACE || type == Triangulation::EDGE ? hint->info() : false;
        if (inside) lattice.push_back(place);
      }
    }
    for (const Kernel::Point_2& p : lattice) triangulation_.insert(p, hint)->info() = none;
  }

  /// Edges of the ring by the cells they come near.
  void mark_ring(const Box& box, double apart) {
    box_ = box;
    cell_ = std::max(2 * apart, std::max(box.xmax - box.xmin, box.ymax - box.ymin) / 4096);
    columns_ = static_cast<int>((box.xmax - box.xmin) / cell_) + 1;
    cells_.resize(static_cast<std::size_t>(columns_) * (static_cast<int>((box.ymax - box.ymin) / cell_) + 1));
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const Point2 p = ring_[i], q = ring_[(i + 1) % ring_.size()];
      each_cell({std::min(p.x, q.x) - apart, std::min(p.y, q.y) - apart, std::max(p.x, q.x) + apart,
                 std::max(p.y, q.y) + apart},
                [&](std::size_t cell) { cells_[cell].push_back(static_cast<Index>(i)); });
    }
  }

  template <class Visit>
  void each_cell(const Box& box, Visit visit) const {
    const int rows = static_cast<int>(cells_.size() / columns_);
    const auto index = [&](double offset, int count) {
      return static_cast<int>(std::clamp(std::floor(offset / cell_), 0.0, count - 1.0));
    };
    for (int r = index(box.ymin - box_.ymin, rows); r <= index(box.ymax - box_.ymin, rows); ++r)
      for (int c = index(box.xmin - box_.xmin, columns_); c <= index(box.xmax - box_.xmin, columns_); ++c)
        visit(static_cast<std::size_t>(r) * columns_ + c);
  }

  bool near_ring(Point2 p, double apart) const {
    bool near = false;
    each_cell({p.x, p.y, p.x, p.y}, [&](std::size_t cell) {
      for (const Index i : cells_[cell]) {
        double d;
        nearest_on_segment(ring_[i], ring_[(i + 1) % ring_.size()], p, d);
        near = near || d < apart;
      }
    });
    return near;
  }

  /// Puts a vertex in the middle of every edge inside that is too long and still there when its turn comes. False when
  /// there was none.
  bool halve_long_edges() {
    find_inside();
    struct Long {
      double length;
      Point2 from, to;
      Vertex v, w;
    };
    std::vector<Long> found;
    for (auto e = triangulation_.finite_edges_begin(); e != triangulation_.finite_edges_end(); ++e) {
      const auto& [f, k] = *e;
      if (f->is_constrained(k) || !f->info()) continue;
      Vertex v = f->vertex(Triangulation::ccw(k)), w = f->vertex(Triangulation::cw(k));
      const auto before = [](Vertex s, Vertex t) {
        return std::tuple(at(s).x, at(s).y) < std::tuple(at(t).x, at(t).y);
      };
      if (before(w, v)) std::swap(v, w);
      if (length(v, w) > max_edge_) found.push_back({length(v, w), at(v), at(w), v, w});
    }
    // By what they are and not by where they are kept: the same for every run.
    std::sort(found.begin(), found.end(), [](const Long& s, const Long& t) {
      return std::tuple(-s.length, s.from.x, s.from.y, s.to.x, s.to.y) <
             std::tuple(-t.length, t.from.x, t.from.y, t.to.x, t.to.y);
    });
    for (const Long& e : found) {
      Triangulation::Face_handle f;
      int k;
      if (!triangulation_.is_edge(e.v, e.w, f, k)) continue;
      triangulation_.insert(Kernel::Point_2(mix(e.from.x, e.to.x, 0.5), mix(e.from.y, e.to.y, 0.5)), f)->info() = none;
    }
    return !found.empty();
  }

  PlainMesh mesh() {
    PlainMesh mesh;
    for (auto f = triangulation_.finite_faces_begin(); f != triangulation_.finite_faces_end(); ++f) {
      if (!f->info()) continue;
      for (int k = 0; k < 3; ++k) f->vertex(k)->info() = none;
    }
    for (auto f = triangulation_.finite_faces_begin(); f != triangulation_.finite_faces_end(); ++f) {
      if (!f->info()) continue;
      Face face;
      for (int k = 0; k < 3; ++k) {
        Index& number = f->vertex(k)->info();
        if (number == none) {
          number = static_cast<Index>(mesh.points.size());
          mesh.points.push_back(at(f->vertex(k)));
        }
        face[k] = number;
      }
      mesh.faces.push_back(face);
    }
    return mesh;
  }

  std::span<const Point2> ring_;
  double max_edge_;
  const Context& context_;
  Triangulation triangulation_;
  Box box_{};
  double cell_ = 1;
  int columns_ = 1;
  std::vector<std::vector<Index>> cells_;
};

}  // namespace

PlainMesh fill_ring(std::span<const Point2> ring, double max_edge, const Context& context) {
  return RingFiller(ring, max_edge, context).run();
}

}  // namespace terrane
