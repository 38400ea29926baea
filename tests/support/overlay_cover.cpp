// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/overlay_cover.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>

#include "support/cells.hpp"
#include "support/exact.hpp"
#include "support/plan_mesh.hpp"

namespace terrane::support {
namespace {

using Parents = std::array<Index, 2>;

double distance(Point2 p, Point2 q) { return static_cast<double>(length(p.x - q.x, p.y - q.y)); }

double perimeter(const Triangle& t) { return distance(t[0], t[1]) + distance(t[1], t[2]) + distance(t[2], t[0]); }

long double area(const Triangle& t) {
  const long double ux = static_cast<long double>(t[1].x) - t[0].x, uy = static_cast<long double>(t[1].y) - t[0].y,
                    vx = static_cast<long double>(t[2].x) - t[0].x, vy = static_cast<long double>(t[2].y) - t[0].y;
  return (ux * vy - uy * vx) / 2;
}

struct Edge {
  Point2 p, q;
  Box box;
};

Edge edge(Point2 p, Point2 q) {
  return {p, q, {std::min(p.x, q.x), std::min(p.y, q.y), std::max(p.x, q.x), std::max(p.y, q.y)}};
}

bool near(Point2 p, const Edge& e, double reach) {
  return p.x >= e.box.xmin - reach && p.x <= e.box.xmax + reach && p.y >= e.box.ymin - reach &&
         p.y <= e.box.ymax + reach && within(p, e.p, e.q, reach);
}

class Cover {
 public:
  Cover(const Tin& a, const Tin& b, Refinement refinement, const Overlay& overlay)
      : inputs_{&a, &b}, refinement_(refinement), overlay_(overlay), cells_(shared_cells(a, b)) {
    reach_ = 3 * overlay.rounding.max_move + 1e-300;  // products of denormal distances are none that doubles hold
    for (const int m : {0, 1}) meshes_[m] = plan_mesh(*inputs_[m]);
    wrong_.precision(17);
  }

  std::string judged() {
    judge_parts();
    judge_whole();
    judge_edges(0);
    if (refinement_ == Refinement::full) judge_edges(1);
    judge_border();
    return wrong_.str();
  }

 private:
  /// By how much areas may be off: what the border of the part can have been moved, and the error of measuring.
  double slack(double border, double extent) const { return 2 * reach_ * border + 1e-17 * extent * extent; }

  /// Each pair of parents must cover what the two faces share, each lone parent what is left of it.
  void judge_parts() {
    struct Part {
      long double wanted = 0, found = 0;
      double border = 0, extent = 0;
      bool has_face = false;
    };
    std::map<Parents, Part> parts;
    for (const int m : {0, 1})
      for (const Index f : meshes_[m].face_in_tin) {
        const Triangle t = triangle(*inputs_[m], f);
        Part& lone = parts[m == 0 ? Parents{f, none} : Parents{none, f}];
        lone.wanted = area(t), lone.border = perimeter(t), lone.extent = lone.border;
      }
    std::size_t shared = 0;
    for (const Cell& cell : cells_) {
      const double extent = parts[{cell.a, none}].extent + parts[{none, cell.b}].extent;
      if (refinement_ == Refinement::full) {
        Part& both = parts[{cell.a, cell.b}];
        both.wanted = cell.area, both.border = cell.perimeter, both.extent = extent;
        ++shared;
      }
      for (const Parents lone : {Parents{cell.a, none}, Parents{none, cell.b}}) {
        if (refinement_ == Refinement::paste && lone[0] != none) continue;
        Part& rest = parts[lone];
        rest.wanted -= cell.area, rest.border += cell.perimeter, rest.extent = std::max(rest.extent, extent);
      }
    }
    for (std::size_t f = 0; f < overlay_.faces.size(); ++f) {
      const Triangle t = triangle(overlay_.points, overlay_.faces[f]);
      Part& part = parts[overlay_.parents[f]];
      part.has_face = true;
      part.found += area(t), part.border += perimeter(t), part.extent = std::max(part.extent, perimeter(t));
    }
    std::size_t lost = 0;
    for (const auto& [parents, part] : parts) {
      const double allowed = slack(part.border, part.extent);
      if (!(std::fabs(part.found - part.wanted) <= allowed))
        wrong_ << "parents " << parents[0] << " " << parents[1] << " cover " << part.found << " instead of "
               << part.wanted << ", off by more than " << allowed << "; ";
      lost += parents[0] != none && parents[1] != none && part.wanted > 0 && !part.has_face;
    }
    const RoundingReport& report = overlay_.rounding;
    if (lost > static_cast<std::size_t>(report.collapsed))
      wrong_ << lost << " regions have no face, " << report.collapsed << " are reported; ";
    if (shared > static_cast<std::size_t>(report.regions))
      wrong_ << shared << " pairs of faces meet, " << report.regions << " regions are reported; ";
  }

  /// The area of the union, but for what rounding moves crossings of borders. Where nothing moved it must be exact.
  void judge_whole() {
    ExactSum twice;
    double border = 0;
    const auto add = [&](const Triangle& t, double sign) {
      for (int k = 0; k < 3; ++k) {
        twice.add_product(sign * t[k].x, t[(k + 1) % 3].y);
        twice.add_product(-sign * t[k].y, t[(k + 1) % 3].x);
      }
    };
    for (const Face& f : overlay_.faces) add(triangle(overlay_.points, f), 1);
    for (const int m : {0, 1}) {
      for (const Index f : meshes_[m].face_in_tin) add(triangle(*inputs_[m], f), -1);
      for (const auto& [u, v] : border_of(meshes_[m].faces))
        border += distance(meshes_[m].points[u], meshes_[m].points[v]);
    }
    long double shared = 0;
    for (const Cell& cell : cells_) shared += cell.area;
    const double delta = overlay_.rounding.max_move;
    const double off = static_cast<double>(twice.value() / 2 + shared), allowed = (delta + 1e-300) * border;
    const double doubt = 1e-17 * border * border;
    if (std::fabs(off) + doubt <= allowed) return;
    if (std::fabs(off) - doubt <= allowed && cells_.size() > 20) return;  // rationals take 20 us a cell
    mpq_class exact = twice.rational() / 2;
    for (const Cell& cell : cells_)
      exact += shared_area_exact(triangle(*inputs_[0], cell.a), triangle(*inputs_[1], cell.b));
    if (abs(exact) > mpq_class(allowed))
      wrong_ << "the area is off by " << exact.get_d() << ", allowed are " << allowed << "; ";
  }

  /// Every edge of an input is a chain of edges of the result that runs within reach of it, but for the tips of faces
  /// where they are thinner than that.
  void judge_edges(int m) {
    std::vector<std::array<Index, 3>> halves;  // the ends u < v of an edge and the parent on one side of it
    for (std::size_t f = 0; f < overlay_.faces.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        const auto [u, v] = std::minmax(overlay_.faces[f][k], overlay_.faces[f][(k + 1) % 3]);
        halves.push_back({u, v, overlay_.parents[f][m]});
      }
    std::sort(halves.begin(), halves.end());
    std::vector<std::array<Index, 2>> all, between;  // those between two parents are what the input's edges left
    for (std::size_t i = 0; i < halves.size(); ++i) {
      const auto [u, v, parent] = halves[i];
      const bool two = i + 1 < halves.size() && halves[i + 1][0] == u && halves[i + 1][1] == v;
      const Index across = two ? halves[++i][2] : none;
      all.push_back({u, v});
      if (parent != across) between.push_back({u, v});
    }
    std::array<Index, 2> looked_at = {none, none};
    for (const InputEdge& e : input_edges(meshes_[m])) {
      const Point2 p = meshes_[m].points[e.ends[0]], q = meshes_[m].points[e.ends[1]];
      const Index from = vertex_at(p), to = vertex_at(q);
      if (from == none || to == none) continue;  // a missing vertex is said elsewhere
      if (e.ends != looked_at) {
        near_.clear();
        for (const Point2 r : overlay_.points) near_.push_back(near(r, edge(p, q), reach_));
        looked_at = e.ends;
      }
      const auto covered_by = [&](const auto& edges) { return connected({from, to}, e.tips, edges); };
      if (!covered_by(between) && !covered_by(all))
        wrong_ << "edge " << p.x << " " << p.y << " - " << q.x << " " << q.y << " of input " << m
               << " is not covered; ";
    }
  }

  /// An edge of a face that is thicker than rounding, and how long its tips are at the ends that are not. An edge of two
  /// faces is here once for each, next to each other: it is to be covered by the measure of both.
  struct InputEdge {
    std::array<Index, 2> ends;
    std::array<double, 2> tips;
  };
  std::vector<InputEdge> input_edges(const PlanMesh& mesh) const {
    std::vector<InputEdge> edges;
    for (const Face& f : mesh.faces) {
      const Triangle t = triangle(mesh.points, f);
      if (thickness(t) <= reach_) continue;  // such a face may go
      const auto tip = [&](int k) {
        const Point2 p = t[k], q = t[(k + 1) % 3], r = t[(k + 2) % 3];
        if ((q.x - p.x) * (r.x - p.x) + (q.y - p.y) * (r.y - p.y) <= 0) return reach_;  // none
        return reach_ * distance(p, q) * distance(p, r) / static_cast<double>(2 * area(t));
      };
      for (int k = 0; k < 3; ++k) {
        const int u = f[k] < f[(k + 1) % 3] ? k : (k + 1) % 3, v = u == k ? (k + 1) % 3 : k;
        edges.push_back({{f[u], f[v]}, {tip(u), tip(v)}});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const InputEdge& e, const InputEdge& f) { return e.ends < f.ends; });
    return edges;
  }

  Index vertex_at(Point2 p) const {
    const auto found = std::find(overlay_.points.begin(), overlay_.points.end(), p);
    return found == overlay_.points.end() ? none : static_cast<Index>(found - overlay_.points.begin());
  }

  /// By edges whose ends are near. What is as near to one of the two as its tip is long counts as that one.
  bool connected(std::array<Index, 2> ends, std::array<double, 2> tips,
                 const std::vector<std::array<Index, 2>>& edges) {
    group_.resize(overlay_.points.size());
    std::iota(group_.begin(), group_.end(), 0);
    const auto root = [&](Index v) {
      while (group_[v] != v) v = group_[v] = group_[group_[v]];
      return v;
    };
    for (Index v = 0; v < static_cast<Index>(overlay_.points.size()); ++v)
      for (const int i : {0, 1})
        if (near_[v] && distance(overlay_.points[v], overlay_.points[ends[i]]) <= tips[i])
          group_[root(v)] = root(ends[i]);
    for (const auto& [u, v] : edges)
      if (near_[u] && near_[v]) group_[root(u)] = root(v);
    return root(ends[0]) == root(ends[1]);
  }

  /// Every edge of the border runs along the border of an input: each of its points is within reach of it, one edge for
  /// all of them or, past a vertex, one after the other.
  void judge_border() {
    std::array<std::vector<Edge>, 2> borders;
    for (const int m : {0, 1})
      for (const auto& [u, v] : border_of(meshes_[m].faces))
        borders[m].push_back(edge(meshes_[m].points[u], meshes_[m].points[v]));
    for (const auto& [u, v] : border_of(overlay_.faces)) {
      const Point2 p = overlay_.points[u], q = overlay_.points[v];
      const auto along_one = [&](const Edge& e) { return near(p, e, reach_) && near(q, e, reach_); };
      const auto along = [&](const std::vector<Edge>& border) {
        return std::any_of(border.begin(), border.end(), along_one) || runs_along(border, p, q, 0, 1);
      };
      if (!along(borders[0]) && !along(borders[1]))
        wrong_ << "the border at " << p.x << " " << p.y << " - " << q.x << " " << q.y << " is nobody's; ";
    }
  }

  /// Of the edge p q the part between two places, given as fractions: there may be no doubles between p and q. What is
  /// near one edge is convex, so two places near it do for all between them; else both halves are looked at.
  bool runs_along(const std::vector<Edge>& border, Point2 p, Point2 q, long double from, long double to) const {
    using Real = long double;
    const auto is_near = [&](const Edge& e, Real at) {  // seen from p, where differences are exact
      const Real x = at * (Real(q.x) - p.x) - (Real(e.p.x) - p.x), y = at * (Real(q.y) - p.y) - (Real(e.p.y) - p.y);
      const Real dx = Real(e.q.x) - e.p.x, dy = Real(e.q.y) - e.p.y;
      const Real along = std::clamp<Real>((x * dx + y * dy) / (dx * dx + dy * dy), 0, 1);
      return length(x - along * dx, y - along * dy) <= reach_;
    };
    const Real middle = (from + to) / 2;
    bool middle_near = false;
    for (const Edge& e : border) {
      if (is_near(e, from) && is_near(e, to)) return true;
      middle_near = middle_near || is_near(e, middle);
    }
    if (!middle_near || to - from < 1e-12L) return false;
    return runs_along(border, p, q, from, middle) && runs_along(border, p, q, middle, to);
  }

  std::array<const Tin*, 2> inputs_;
  Refinement refinement_;
  const Overlay& overlay_;
  std::vector<Cell> cells_;
  std::array<PlanMesh, 2> meshes_;
  double reach_ = 0;
  std::vector<bool> near_;  // per vertex of the result: the edge looked at is within reach
  std::vector<Index> group_;
  std::ostringstream wrong_;
};

}  // namespace

std::string wrong_cover(const Tin& a, const Tin& b, Refinement refinement, const Overlay& overlay) {
  return Cover(a, b, refinement, overlay).judged();
}

}  // namespace terrane::support
