// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/plan/delaunay.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "core/plan/insertion_order.hpp"

namespace terrane {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Structure = CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_with_info_2<Index, Kernel>,
                                                       CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                               CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Vertex = Triangulation::Vertex_handle;

/// Puts the points in and says which vertex each is; none for those at the place of another.
template <class Point>
std::vector<Vertex> insert(std::span<const Point> points, Triangulation& triangulation) {
  std::vector<std::pair<Kernel::Point_2, Index>> places;
  places.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    places.emplace_back(Kernel::Point_2(points[i].x, points[i].y), static_cast<Index>(i));
  triangulation.insert(places.begin(), places.end());
  std::vector<Vertex> vertices(points.size());
  for (auto v = triangulation.finite_vertices_begin(); v != triangulation.finite_vertices_end(); ++v)
    vertices[v->info()] = v;
  return vertices;
}

}  // namespace

Tin constrained_delaunay(std::span<const Point> points, std::span<const std::array<Index, 2>> edges) {
  Triangulation triangulation;
  const std::vector<Vertex> vertices = insert(points, triangulation);
  for (const auto& [from, to] : edges) triangulation.insert_constraint(vertices[from], vertices[to]);
  Tin tin{{points.begin(), points.end()}, {}};
  for (auto f = triangulation.finite_faces_begin(); f != triangulation.finite_faces_end(); ++f)
    tin.faces.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
  return tin;
}

bool meet_at_ends_only(std::span<const Point2> points, std::vector<std::array<Index, 2>> edges) {
  Triangulation triangulation;
  const std::vector<Vertex> vertices = insert(points, triangulation);
  order_for_insertion(edges);
  try {
    for (const auto& [from, to] : edges) triangulation.insert_constraint(vertices[from], vertices[to]);
  } catch (const Triangulation::Intersection_of_constraints_exception&) {
    return false;
  }
  return std::all_of(edges.begin(), edges.end(),
                     [&](const auto& e) { return triangulation.is_edge(vertices[e[0]], vertices[e[1]]); });
}

}  // namespace terrane
