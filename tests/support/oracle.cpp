// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/oracle.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_plus_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace terrane::support {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Number = Kernel::FT;
using ExactPoint = Kernel::Point_2;

struct Mark {
  int region = -1;
  std::array<Index, 2> parents = {none, none};
};

using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using FaceBase =
    CGAL::Constrained_triangulation_face_base_2<Kernel, CGAL::Triangulation_face_base_with_info_2<Mark, Kernel>>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
// "Plus" crosses the constraints as they came, not their pieces: exact numbers would nest deeper with every crossing.
using Triangulation = CGAL::Constrained_triangulation_plus_2<
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::Exact_intersections_tag>>;

ExactPoint exact(const Point& p) { return {p.x, p.y}; }

double nearest(const Number& value) {
  const auto& e = CGAL::exact(value);
  using Exact = std::decay_t<decltype(e)>;
  const double d = CGAL::to_double(e);
  const Exact at(d);
  if (at == e) return d;
  const double other =
      std::nextafter(d, at < e ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity());
  const Exact l = CGAL::abs(Exact(e - at)), r = CGAL::abs(Exact(Exact(other) - e));
  return r < l ? other : d;
}

/// Finds the face of a TIN that holds a place, by buckets of a coarse grid.
class Locator {
 public:
  explicit Locator(const Tin& tin) : tin_(tin), box_(bounds(tin)) {
    cells_.resize(size * size);
    for (std::size_t f = 0; f < tin.faces.size(); ++f) {
      if (is_wall(tin, tin.faces[f])) continue;
      int lo[2] = {size, size}, hi[2] = {-1, -1};
      for (const Index v : tin.faces[f]) {
        const int c[2] = {cell(tin.vertices[v].x, box_.xmin, box_.xmax), cell(tin.vertices[v].y, box_.ymin, box_.ymax)};
        for (int i : {0, 1}) lo[i] = std::min(lo[i], c[i]), hi[i] = std::max(hi[i], c[i]);
      }
      // One cell wider than the face: the bucket of an exact place is found from its rounded coordinates.
      for (int j = std::max(0, lo[1] - 1); j <= std::min(size - 1, hi[1] + 1); ++j)
        for (int i = std::max(0, lo[0] - 1); i <= std::min(size - 1, hi[0] + 1); ++i)
          cells_[j * size + i].push_back(static_cast<Index>(f));
    }
  }

  Index face_at(const ExactPoint& p) const {
    if (tin_.faces.empty()) return none;
    const double x = CGAL::to_double(p.x()), y = CGAL::to_double(p.y());
    for (const Index f : cells_[cell(y, box_.ymin, box_.ymax) * size + cell(x, box_.xmin, box_.xmax)]) {
      bool inside = true;
      for (int k = 0; k < 3 && inside; ++k)
        inside = CGAL::orientation(exact(tin_.vertices[tin_.faces[f][k]]),
                                   exact(tin_.vertices[tin_.faces[f][(k + 1) % 3]]), p) != CGAL::RIGHT_TURN;
      if (inside) return f;
    }
    return none;
  }

 private:
  static constexpr int size = 48;
  static int cell(double v, double lo, double hi) {
    return hi > lo ? std::clamp(static_cast<int>((v - lo) / (hi - lo) * size), 0, size - 1) : 0;
  }
  const Tin& tin_;
  Box box_;
  std::vector<std::vector<Index>> cells_;
};

Number exact_height(const Tin& tin, Index f, const ExactPoint& p) {
  const Point &a = tin.vertices[tin.faces[f][0]], &b = tin.vertices[tin.faces[f][1]],
              &c = tin.vertices[tin.faces[f][2]];
  const Number wa = CGAL::area(exact(b), exact(c), p), wb = CGAL::area(exact(c), exact(a), p),
               wc = CGAL::area(exact(a), exact(b), p);
  return (wa * Number(a.z) + wb * Number(b.z) + wc * Number(c.z)) / (wa + wb + wc);
}

bool jumps(const Tin& tin) {
  std::map<std::pair<double, double>, double> seen;
  for (const Face& f : tin.faces)
    if (!is_wall(tin, f))
      for (const Index v : f) {
        const Point& p = tin.vertices[v];
        if (seen.emplace(std::pair(p.x, p.y), p.z).first->second != p.z) return true;
      }
  return false;
}

class Oracle {
 public:
  Oracle(const Tin& a, const Tin& b) : tins_{&a, &b}, locators_{Locator(a), Locator(b)} {
    for (const Tin* tin : tins_) insert(*tin);
    mark();
  }

  Overlay result() const {
    Overlay overlay;
    std::map<Triangulation::Vertex_handle, Index> index;
    std::vector<ExactPoint> places;
    for (auto v : triangulation_.finite_vertex_handles()) {
      index[v] = static_cast<Index>(places.size());
      places.push_back(v->point());
      overlay.points.push_back({nearest(v->point().x()), nearest(v->point().y())});
    }
    for (int input : {0, 1}) {
      overlay.per_corner[input] = jumps(*tins_[input]);
      if (!overlay.per_corner[input]) overlay.heights[input].assign(places.size(), 0);
    }
    for (auto f : triangulation_.finite_face_handles()) {
      const auto parents = f->info().parents;
      if (parents[0] == none && parents[1] == none) continue;
      overlay.faces.push_back({index[f->vertex(0)], index[f->vertex(1)], index[f->vertex(2)]});
      overlay.parents.push_back(parents);
      for (int input : {0, 1})
        for (const Index v : overlay.faces.back()) {
          const double z = parents[input] == none ? 0 : nearest(exact_height(*tins_[input], parents[input], places[v]));
          if (overlay.per_corner[input])
            overlay.heights[input].push_back(z);
          else if (parents[input] != none)
            overlay.heights[input][v] = z;
        }
    }
    overlay.rounding.regions = static_cast<Index>(counts().regions);
    return overlay;
  }

  OracleCounts counts() const {
    OracleCounts counts;
    std::set<int> regions;
    // Summed as rationals: a lazy sum is as deep as it is long, and evaluating it would overflow the stack.
    Kernel::Exact_kernel::FT area = 0, overlap = 0;
    for (auto f : triangulation_.finite_face_handles()) {
      const Mark& mark = f->info();
      if (mark.parents[0] == none && mark.parents[1] == none) continue;
      regions.insert(mark.region);
      const auto a = CGAL::exact(CGAL::area(f->vertex(0)->point(), f->vertex(1)->point(), f->vertex(2)->point()));
      area += a;
      if (mark.parents[0] != none && mark.parents[1] != none) overlap += a;
    }
    counts.regions = regions.size();
    counts.vertices = triangulation_.number_of_vertices();
    counts.area = nearest(Number(area));
    counts.overlap_area = nearest(Number(overlap));
    return counts;
  }

 private:
  void insert(const Tin& tin) {
    std::vector<Triangulation::Vertex_handle> handles(tin.vertices.size());
    Triangulation::Face_handle hint;
    std::set<std::pair<Index, Index>> edges;
    for (const Face& f : tin.faces) {
      if (is_wall(tin, f)) continue;
      for (int k = 0; k < 3; ++k) edges.insert(std::minmax(f[k], f[(k + 1) % 3]));
      for (const Index v : f)
        if (handles[v] == Triangulation::Vertex_handle()) {
          handles[v] = triangulation_.insert(exact(tin.vertices[v]), hint);
          hint = handles[v]->face();
        }
    }
    for (const auto& [p, q] : edges) triangulation_.insert_constraint(handles[p], handles[q]);
  }

  void mark() {
    int region = 0;
    for (auto start : triangulation_.finite_face_handles()) {
      if (start->info().region >= 0) continue;
      const ExactPoint inside =
          CGAL::centroid(start->vertex(0)->point(), start->vertex(1)->point(), start->vertex(2)->point());
      const Mark mark{region++, {locators_[0].face_at(inside), locators_[1].face_at(inside)}};
      std::vector<Triangulation::Face_handle> stack{start};
      start->info() = mark;
      while (!stack.empty()) {
        const auto f = stack.back();
        stack.pop_back();
        for (int k = 0; k < 3; ++k) {
          const auto g = f->neighbor(k);
          if (f->is_constrained(k) || triangulation_.is_infinite(g) || g->info().region >= 0) continue;
          g->info() = mark;
          stack.push_back(g);
        }
      }
    }
  }

  std::array<const Tin*, 2> tins_;
  std::array<Locator, 2> locators_;
  Triangulation triangulation_;
};

}  // namespace

Overlay oracle_overlay(const Tin& a, const Tin& b) { return Oracle(a, b).result(); }

OracleCounts oracle_counts(const Tin& a, const Tin& b) { return Oracle(a, b).counts(); }

double oracle_height(const Tin& tin, Point2 at) {
  const ExactPoint p(at.x, at.y);
  for (std::size_t f = 0; f < tin.faces.size(); ++f) {
    const Face& t = tin.faces[f];
    if (is_wall(tin, t)) continue;
    bool inside = true;
    for (int k = 0; k < 3 && inside; ++k)
      inside = CGAL::orientation(exact(tin.vertices[t[k]]), exact(tin.vertices[t[(k + 1) % 3]]), p) != CGAL::RIGHT_TURN;
    if (inside) return nearest(exact_height(tin, static_cast<Index>(f), p));
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace terrane::support
