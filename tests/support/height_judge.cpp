// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/height_judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace terrane::support {
namespace {

template <class Number>
struct Spot {
  Number x, y;
};

template <class Number>
Number cross(const Spot<Number>& a, const Spot<Number>& b) {
  return a.x * b.y - a.y * b.x;
}

/// A triangle relative to its first corner, with the plane over it.
template <class Number>
struct Plane {
  Spot<Number> u, v, p;  // two corners and the place in question
  Number area, z0, du, dv;

  Plane(const Triangle& t, const std::array<double, 3>& z, Point2 at)
      : u{Number(t[1].x) - t[0].x, Number(t[1].y) - t[0].y},
        v{Number(t[2].x) - t[0].x, Number(t[2].y) - t[0].y},
        p{Number(at.x) - t[0].x, Number(at.y) - t[0].y},
        area(cross(u, v)),
        z0(z[0]),
        du(Number(z[1]) - z[0]),
        dv(Number(z[2]) - z[0]) {}

  Spot<Number> corner(int k) const { return k == 0 ? Spot<Number>{Number(0), Number(0)} : k == 1 ? u : v; }

  Number height(const Spot<Number>& s) const { return z0 + (cross(s, v) * du + cross(u, s) * dv) / area; }

  Number slope_x() const { return (v.y * du - u.y * dv) / area; }
  Number slope_y() const { return (u.x * dv - v.x * du) / area; }

  /// The place of the triangle that is nearest to p; `turns`: of p against the edges.
  Spot<Number> nearest(const int (&turns)[3]) const {
    Spot<Number> best = p;
    Number least = -1;
    for (int k = 0; k < 3; ++k) {
      if (turns[k] >= 0) continue;
      const Spot<Number> a = corner(k), b = corner((k + 1) % 3), d{Number(b.x - a.x), Number(b.y - a.y)};
      Number t = ((p.x - a.x) * d.x + (p.y - a.y) * d.y) / (d.x * d.x + d.y * d.y);
      if (t < 0) t = 0;
      if (t > 1) t = 1;
      const Spot<Number> q{Number(a.x + t * d.x), Number(a.y + t * d.y)};
      const Number distance2 = (q.x - p.x) * (q.x - p.x) + (q.y - p.y) * (q.y - p.y);
      if (least < 0 || distance2 < least) least = distance2, best = q;
    }
    return best;
  }
};

struct Corners {
  std::array<double, 3> z;
  double low, high, largest;
};

Corners corners(const Tin& tin, const Face& f) {
  const std::array<double, 3> z{tin.vertices[f[0]].z, tin.vertices[f[1]].z, tin.vertices[f[2]].z};
  const auto [low, high] = std::minmax({z[0], z[1], z[2]});
  return {z, low, high, std::max(std::fabs(low), std::fabs(high))};
}

double ulp(double v) { return std::nextafter(v, std::numeric_limits<double>::infinity()) - v; }

}  // namespace

HeightJudge::HeightJudge(const Tin& tin) : tin_(tin) {
  for (Index f = 0; f < static_cast<Index>(tin.faces.size()); ++f) {
    if (is_wall(tin, tin.faces[f])) continue;
    faces_.push_back(f);
    triangles_.push_back(triangle(tin, f));
    boxes_.push_back(box_of(triangles_.back()));
  }
  const PlanMesh mesh = plan_mesh(tin);
  for (const auto& [u, v] : border_of(mesh.faces)) border_.push_back({mesh.points[u], mesh.points[v]});
}

bool HeightJudge::near(std::size_t i, Point2 p, double radius) const {
  const Box& b = boxes_[i];
  return p.x >= b.xmin - radius && p.x <= b.xmax + radius && p.y >= b.ymin - radius && p.y <= b.ymax + radius &&
         within(p, triangles_[i], radius);
}

/// Heights within a doubled radius of the nearest place: they hold all of the disk's.
HeightJudge::Range HeightJudge::quick(std::size_t i, Point2 p, double radius, double& doubt) const {
  const Triangle& t = triangles_[i];
  const Corners c = corners(tin_, tin_.faces[faces_[i]]);
  const Plane<long double> plane(t, c.z, p);
  const int turns[3] = {turn(t[0], t[1], p), turn(t[1], t[2], p), turn(t[2], t[0], p)};
  const long double z = plane.height(plane.nearest(turns));
  const long double spread = 2 * radius * length(plane.slope_x(), plane.slope_y());
  const long double extent = std::max({std::fabs(plane.u.x), std::fabs(plane.u.y), std::fabs(plane.v.x),
                                       std::fabs(plane.v.y), std::fabs(plane.p.x), std::fabs(plane.p.y)});
  doubt = 1e-18L * (c.high - c.low) * (1 + extent * extent / std::fabs(plane.area));
  const double slack = 4 * ulp(c.largest);
  return {true, static_cast<double>(std::max<long double>(z - spread + doubt, c.low)) - slack,
          static_cast<double>(std::min<long double>(z + spread - doubt, c.high)) + slack};
}

HeightJudge::Range HeightJudge::exact(std::size_t i, Point2 p, double radius) const {
  const Triangle& t = triangles_[i];
  const Corners c = corners(tin_, tin_.faces[faces_[i]]);
  const Plane<mpq_class> plane(t, c.z, p);
  const int turns[3] = {turn(t[0], t[1], p), turn(t[1], t[2], p), turn(t[2], t[0], p)};
  const mpq_class z = plane.height(plane.nearest(turns));
  const double spread =
      radius == 0 ? 0 : 2 * radius * std::hypot(plane.slope_x().get_d(), plane.slope_y().get_d()) * (1 + 1e-12);
  const double slack = 4 * ulp(c.largest), height = z.get_d(), rounding = 2 * ulp(std::fabs(height));
  return {true, std::max(height - spread - rounding, c.low) - slack,
          std::min(height + spread + rounding, c.high) + slack};
}

HeightJudge::Range HeightJudge::range(Point2 p, double radius) const {
  Range all;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    if (!near(i, p, radius)) continue;
    double doubt;
    Range one = quick(i, p, radius, doubt);
    if (!(doubt < 1e-16 * (std::fabs(one.low) + std::fabs(one.high)))) one = exact(i, p, radius);
    all = all.found ? Range{true, std::min(all.low, one.low), std::max(all.high, one.high)} : one;
  }
  return all;
}

bool HeightJudge::allows(Point2 p, double radius, double z, Index guess) const {
  const auto at = std::lower_bound(faces_.begin(), faces_.end(), guess);
  if (at != faces_.end() && *at == guess) {
    const std::size_t i = at - faces_.begin();
    double doubt;
    const Range there = quick(i, p, radius, doubt);
    if (there.low <= z && z <= there.high && near(i, p, radius)) return true;
  }
  const Range all = range(p, radius);
  return all.found && all.low <= z && z <= all.high;
}

bool HeightJudge::at_border(Point2 p, double radius) const {
  return std::any_of(border_.begin(), border_.end(),
                     [&](const std::array<Point2, 2>& e) { return within(p, e[0], e[1], radius); });
}

double HeightJudge::steepness(Point2 p, double radius) const {
  double slope = 0;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    if (!near(i, p, radius)) continue;
    const Plane<long double> plane(triangles_[i], corners(tin_, tin_.faces[faces_[i]]).z, p);
    slope = std::max(slope, static_cast<double>(length(plane.slope_x(), plane.slope_y())));
  }
  return slope;
}

double HeightJudge::largest(Point2 p, double radius) const {
  double z = 0;
  for (std::size_t i = 0; i < faces_.size(); ++i)
    if (near(i, p, radius))
      for (const Index v : tin_.faces[faces_[i]]) z = std::max(z, std::fabs(tin_.vertices[v].z));
  return z;
}

}  // namespace terrane::support
