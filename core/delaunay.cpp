// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/delaunay.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <utility>
#include <vector>

namespace terrane {

Tin constrained_delaunay(std::span<const Point> points, std::span<const std::array<Index, 2>> edges) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Structure = CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_with_info_2<Index, Kernel>,
                                                         CGAL::Constrained_triangulation_face_base_2<Kernel>>;
  using Triangulation =
      CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                                 CGAL::No_constraint_intersection_requiring_constructions_tag>;
  std::vector<std::pair<Kernel::Point_2, Index>> places;
  places.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    places.emplace_back(Kernel::Point_2(points[i].x, points[i].y), static_cast<Index>(i));
  Triangulation triangulation;
  triangulation.insert(places.begin(), places.end());
  std::vector<Triangulation::Vertex_handle> handles(points.size());
  for (auto v = triangulation.finite_vertices_begin(); v != triangulation.finite_vertices_end(); ++v)
    handles[v->info()] = v;
  for (const auto& [from, to] : edges) triangulation.insert_constraint(handles[from], handles[to]);
  Tin tin{{points.begin(), points.end()}, {}};
  for (auto f = triangulation.finite_faces_begin(); f != triangulation.finite_faces_end(); ++f)
    tin.faces.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
  return tin;
}

}  // namespace terrane
