// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/plan/region_fill.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <unordered_map>

#include "core/plan/exact_point.hpp"

namespace terrane {
namespace {

template <class Kernel>
struct Filler {
  struct FaceInfo {
    Index number = none;  // in the result
    bool inside = false;
    std::array<Index, 3> edge = {none, none,
                                 none};  // border edge opposite corner k with the region on this face's side
  };
  using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Index, Kernel>;
  using FaceBase =
      CGAL::Constrained_triangulation_face_base_2<Kernel, CGAL::Triangulation_face_base_with_info_2<FaceInfo, Kernel>>;
  using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
  using Triangulation =
      CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                                 CGAL::No_constraint_intersection_requiring_constructions_tag>;
  using Point = typename Kernel::Point_2;
  using FaceHandle = typename Triangulation::Face_handle;
  using VertexHandle = typename Triangulation::Vertex_handle;

  Triangulation triangulation;
  std::unordered_map<Index, VertexHandle> handles;

  template <class PointOf>
  bool insert(std::span<const BorderEdge> border, std::span<const Index> inner, PointOf&& point_of) {
    std::vector<Index> used(inner.begin(), inner.end());
    used.reserve(2 * border.size() + inner.size());
    for (const BorderEdge& e : border) used.insert(used.end(), {e.from, e.to});
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    std::vector<std::pair<Point, Index>> points;
    points.reserve(used.size());
    for (Index v : used) points.emplace_back(point_of(v), v);
    triangulation.insert(points.begin(), points.end());
    if (triangulation.number_of_vertices() != used.size()) return false;  // two at one place
    if (triangulation.dimension() < 2) return false;                      // rounded onto one line
    handles.reserve(used.size());
    for (auto v = triangulation.finite_vertices_begin(); v != triangulation.finite_vertices_end(); ++v)
      handles[v->info()] = v;
    try {
      for (const BorderEdge& e : border) triangulation.insert_constraint(handles.at(e.from), handles.at(e.to));
    } catch (const typename Triangulation::Intersection_of_constraints_exception&) {
      return false;
    }
    return triangulation.number_of_vertices() == used.size();
  }

  /// Marks the faces left of every border edge; false when a vertex lies on an edge or two edges claim one side.
  bool mark(std::span<const BorderEdge> border, std::vector<FaceHandle>& inside) {
    for (std::size_t i = 0; i < border.size(); ++i) {
      FaceHandle f;
      int k;
      if (!triangulation.is_edge(handles.at(border[i].from), handles.at(border[i].to), f, k)) return false;
      if (f->vertex(triangulation.ccw(k))->info() != border[i].from) {  // the face whose half-edge runs from -> to
        const FaceHandle g = f->neighbor(k);
        k = triangulation.mirror_index(f, k);
        f = g;
      }
      if (triangulation.is_infinite(f) || f->info().edge[k] != none) return false;
      f->info().edge[k] = static_cast<Index>(i);
      if (f->info().inside) continue;
      f->info().inside = true;
      inside.push_back(f);
    }
    return true;
  }

  /// Numbers the faces that can be reached without crossing the border; false when the flood leaks out of the hull or
  /// through a border edge from its wrong side.
  bool flood(std::vector<FaceHandle>& seeds, FilledRegion& region, std::vector<FaceHandle>& order) {
    std::vector<FaceHandle> stack;
    const auto reach = [&](FaceHandle f) {
      if (f->info().number != none) return;
      f->info().number = static_cast<Index>(order.size());
      order.push_back(f);
      stack.push_back(f);
    };
    for (FaceHandle seed : seeds) {
      region.parts += seed->info().number == none;
      reach(seed);
      while (!stack.empty()) {
        const FaceHandle f = stack.back();
        stack.pop_back();
        for (int k = 0; k < 3; ++k) {
          if (f->info().edge[k] != none) continue;
          if (triangulation.is_infinite(f->neighbor(k)) || f->is_constrained(k)) return false;
          reach(f->neighbor(k));
        }
      }
    }
    return true;
  }

  template <class PointOf>
  FilledRegion fill(std::span<const BorderEdge> border, std::span<const Index> inner, PointOf&& point_of) {
    FilledRegion region;
    std::vector<FaceHandle> seeds, order;
    if (!insert(border, inner, point_of) || !mark(border, seeds) || !flood(seeds, region, order)) return {};
    region.sound = true;
    region.faces.reserve(order.size());
    region.across.reserve(order.size());
    for (FaceHandle f : order) {
      region.faces.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
      std::array<Index, 3> across;
      for (int k = 0; k < 3; ++k) {  // the half-edge from corner k to k + 1 is opposite corner k + 2
        const int opposite = (k + 2) % 3;
        const Index edge = f->info().edge[opposite];
        across[k] = edge != none
                        ? -1 - edge
                        : 4 * f->neighbor(opposite)->info().number + (triangulation.mirror_index(f, opposite) + 1) % 3;
      }
      region.across.push_back(across);
    }
    return region;
  }
};

}  // namespace

FilledRegion fill_region(std::span<const Point2> points, std::span<const BorderEdge> border,
                         std::span<const Index> inner) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  return Filler<Kernel>().fill(border, inner, [&](Index v) { return Kernel::Point_2(points[v].x, points[v].y); });
}

FilledRegion fill_region_exactly(std::span<const Point2> points, const std::function<ExactPlace(Index)>& place,
                                 std::span<const BorderEdge> border) {
  return Filler<ExactKernel>().fill(border, {}, [&](Index v) { return exact_point(place(v), points[v]); });
}

}  // namespace terrane
