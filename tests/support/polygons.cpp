// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/polygons.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <geos_c.h>

#include <stdexcept>

#include "support/plan_mesh.hpp"

namespace terrane::support {
namespace {

GEOSContextHandle_t geos() {
  static const GEOSContextHandle_t handle = GEOS_init_r();
  return handle;
}

GEOSGeometry* checked_geometry(void* geometry) {
  if (!geometry) throw std::runtime_error("GEOS gave up");
  return static_cast<GEOSGeometry*>(geometry);
}

double area_of(GEOSGeometry* geometry) {
  const std::shared_ptr<GEOSGeometry> owner(checked_geometry(geometry), [](auto* g) { GEOSGeom_destroy_r(geos(), g); });
  double area = 0;
  GEOSArea_r(geos(), geometry, &area);
  return area;
}

GEOSGeometry* polygon(const std::vector<Point2>& ring) {
  GEOSCoordSequence* points = GEOSCoordSeq_create_r(geos(), static_cast<unsigned>(ring.size() + 1), 2);
  for (unsigned i = 0; i <= ring.size(); ++i)
    GEOSCoordSeq_setXY_r(geos(), points, i, ring[i % ring.size()].x, ring[i % ring.size()].y);
  return GEOSGeom_createPolygon_r(geos(), GEOSGeom_createLinearRing_r(geos(), points), nullptr, 0);
}

GEOSGeometry* collection(std::vector<GEOSGeometry*> parts) {
  return GEOSGeom_createCollection_r(geos(), GEOS_MULTIPOLYGON, parts.data(), static_cast<unsigned>(parts.size()));
}

std::vector<Point2> points_of(const GEOSGeometry* ring) {
  const GEOSCoordSequence* sequence = GEOSGeom_getCoordSeq_r(geos(), ring);
  unsigned size = 0;
  GEOSCoordSeq_getSize_r(geos(), sequence, &size);
  std::vector<Point2> points;
  for (unsigned i = 0; i + 1 < size; ++i) {
    Point2 p;
    GEOSCoordSeq_getXY_r(geos(), sequence, i, &p.x, &p.y);
    points.push_back(p);
  }
  return points;
}

void collect_rings(const GEOSGeometry* geometry, std::vector<std::vector<Point2>>& rings) {
  const int type = GEOSGeomTypeId_r(geos(), geometry);
  if (type == GEOS_POLYGON && !GEOSisEmpty_r(geos(), geometry)) {
    rings.push_back(points_of(GEOSGetExteriorRing_r(geos(), geometry)));
    for (int i = 0; i < GEOSGetNumInteriorRings_r(geos(), geometry); ++i)
      rings.push_back(points_of(GEOSGetInteriorRingN_r(geos(), geometry, i)));
  }
  if (type == GEOS_MULTIPOLYGON || type == GEOS_GEOMETRYCOLLECTION)
    for (int i = 0; i < GEOSGetNumGeometries_r(geos(), geometry); ++i)
      collect_rings(GEOSGetGeometryN_r(geos(), geometry, i), rings);
}

}  // namespace

Polygons::Polygons(void* geometry)
    : geometry_(checked_geometry(geometry),
                [](void* g) { GEOSGeom_destroy_r(geos(), static_cast<GEOSGeometry*>(g)); }) {}

Polygons Polygons::from_wkt(const std::string& wkt) { return Polygons(GEOSGeomFromWKT_r(geos(), wkt.c_str())); }

Polygons Polygons::from_rings(const std::vector<std::vector<Point2>>& rings) {
  std::vector<GEOSGeometry*> parts;
  for (const auto& ring : rings)
    if (ring.size() >= 3) parts.push_back(polygon(ring));
  return Polygons(collection(std::move(parts)));
}

Polygons Polygons::from_domain(const Tin& tin) {
  std::vector<GEOSGeometry*> parts;
  const PlanMesh mesh = plan_mesh(tin);
  for (const Face& f : mesh.faces) {
    const Triangle t = triangle(mesh.points, f);
    parts.push_back(polygon({t[0], t[1], t[2]}));
  }
  const Polygons all(collection(std::move(parts)));
  return Polygons(GEOSUnaryUnion_r(geos(), static_cast<GEOSGeometry*>(all.geometry_.get())));
}

std::string Polygons::invalidity() const {
  const auto* geometry = static_cast<GEOSGeometry*>(geometry_.get());
  if (GEOSisValid_r(geos(), geometry) == 1) return {};
  char* reason = GEOSisValidReason_r(geos(), geometry);
  const std::string text = reason ? reason : "not valid";
  GEOSFree_r(geos(), reason);
  return text;
}

Polygons Polygons::repaired() const {
  return Polygons(GEOSMakeValid_r(geos(), static_cast<GEOSGeometry*>(geometry_.get())));
}

double Polygons::area() const {
  double area = 0;
  GEOSArea_r(geos(), static_cast<GEOSGeometry*>(geometry_.get()), &area);
  return area;
}

double Polygons::united_area(const Polygons& other) const {
  return area_of(GEOSUnion_r(geos(), static_cast<GEOSGeometry*>(geometry_.get()),
                             static_cast<GEOSGeometry*>(other.geometry_.get())));
}

double Polygons::shared_area(const Polygons& other) const {
  return area_of(GEOSIntersection_r(geos(), static_cast<GEOSGeometry*>(geometry_.get()),
                                    static_cast<GEOSGeometry*>(other.geometry_.get())));
}

std::vector<std::vector<Point2>> Polygons::rings() const {
  std::vector<std::vector<Point2>> rings;
  collect_rings(static_cast<GEOSGeometry*>(geometry_.get()), rings);
  return rings;
}

Tin triangulated(const std::vector<std::vector<Point2>>& rings) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using FaceBase =
      CGAL::Constrained_triangulation_face_base_2<Kernel, CGAL::Triangulation_face_base_with_info_2<int, Kernel>>;
  using Structure =
      CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_with_info_2<Index, Kernel>, FaceBase>;
  CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                             CGAL::No_constraint_intersection_requiring_constructions_tag>
      triangulation;
  const auto at = [](Point2 p) { return Kernel::Point_2(p.x, p.y); };
  for (const auto& ring : rings)
    for (std::size_t i = 0; i < ring.size(); ++i)
      if (!(ring[i] == ring[(i + 1) % ring.size()]))
        triangulation.insert_constraint(at(ring[i]), at(ring[(i + 1) % ring.size()]));

  Tin tin;
  for (auto v : triangulation.finite_vertex_handles()) {
    v->info() = static_cast<Index>(tin.vertices.size());
    tin.vertices.push_back({v->point().x(), v->point().y(), 0});
  }
  // Crossing a ring changes the parity.
  for (auto f : triangulation.all_face_handles()) f->info() = -1;
  if (triangulation.dimension() < 2) return {};
  std::vector<decltype(triangulation)::Face_handle> stack{triangulation.infinite_face()};
  stack[0]->info() = 0;
  while (!stack.empty()) {
    const auto f = stack.back();
    stack.pop_back();
    for (int k = 0; k < 3; ++k) {
      const auto g = f->neighbor(k);
      if (g->info() >= 0) continue;
      g->info() = f->info() ^ (f->is_constrained(k) ? 1 : 0);
      stack.push_back(g);
    }
  }
  for (auto f : triangulation.finite_face_handles())
    if (f->info() == 1) tin.faces.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
  return canonical(tin);
}

}  // namespace terrane::support
