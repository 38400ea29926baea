// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/plan_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <sstream>

namespace terrane::support {
namespace {

bool before(Point2 p, Point2 q) { return p.x != q.x ? p.x < q.x : p.y < q.y; }

std::vector<Point2> in_order(std::span<const Point2> points) {
  std::vector<Point2> sorted(points.begin(), points.end());
  std::sort(sorted.begin(), sorted.end(), before);
  return sorted;
}

std::vector<std::uint64_t> directed_edges(std::span<const Face> faces) {
  std::vector<std::uint64_t> edges;
  for (const Face& f : faces)
    for (int k = 0; k < 3; ++k)
      edges.push_back(static_cast<std::uint64_t>(f[k]) << 32 | static_cast<std::uint32_t>(f[(k + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  return edges;
}

std::uint64_t reversed(std::uint64_t edge) { return edge << 32 | edge >> 32; }

void judge_places(std::span<const Point2> points, std::span<const Face> faces, std::ostream& wrong) {
  const std::vector<Point2> sorted = in_order(points);
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) wrong << "two vertices at " << twice->x << " " << twice->y << "; ";
  std::vector<bool> used(points.size(), false);
  for (const Face& f : faces)
    for (const Index v : f) used[v] = true;
  if (std::find(used.begin(), used.end(), false) != used.end()) wrong << "an unused vertex; ";
}

/// `edges`: directed. Of an edge and its twin one is looked at.
void judge_edges(std::span<const Point2> points, std::span<const std::uint64_t> edges, std::ostream& wrong) {
  const std::vector<Point2> sorted = in_order(points);
  for (const std::uint64_t e : edges) {
    if (e > reversed(e) && std::binary_search(edges.begin(), edges.end(), reversed(e))) continue;
    const Point2 p = points[e >> 32], q = points[e & 0xffffffff];
    const double last = std::max(p.x, q.x);
    const auto by_x = [](Point2 v, double x) { return v.x < x; };
    auto v = std::lower_bound(sorted.begin(), sorted.end(), std::min(p.x, q.x), by_x);
    for (; v != sorted.end() && v->x <= last; ++v)
      if (inside_segment(p, q, *v)) wrong << "T-junction at " << v->x << " " << v->y << "; ";
  }
}

/// Interiors meet nowhere else.
bool interiors_may_meet(const Box& s, const Box& t) {
  return s.xmin < t.xmax && t.xmin < s.xmax && s.ymin < t.ymax && t.ymin < s.ymax;
}

}  // namespace

Box box_of(const Triangle& t) {
  return {std::min({t[0].x, t[1].x, t[2].x}), std::min({t[0].y, t[1].y, t[2].y}), std::max({t[0].x, t[1].x, t[2].x}),
          std::max({t[0].y, t[1].y, t[2].y})};
}

double thickness(const Triangle& t) {
  using Real = long double;
  const Real ux = Real(t[1].x) - t[0].x, uy = Real(t[1].y) - t[0].y, vx = Real(t[2].x) - t[0].x,
             vy = Real(t[2].y) - t[0].y;
  const Real longest = std::max({length(ux, uy), length(vx, vy), length(vx - ux, vy - uy)});
  return static_cast<double>(std::fabs(ux * vy - uy * vx) / longest);
}

std::string wrong_in_plan(std::span<const Point2> points, std::span<const Face> faces) {
  std::ostringstream wrong;
  wrong.precision(17);
  for (const Face& f : faces)
    for (const Index v : f)
      if (v < 0 || static_cast<std::size_t>(v) >= points.size()) return "an index out of range; ";
  judge_places(points, faces, wrong);
  const std::vector<std::uint64_t> edges = directed_edges(faces);
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) wrong << "an edge with two faces on one side; ";
  judge_edges(points, edges, wrong);

  std::vector<Triangle> triangles;
  std::vector<Box> boxes;
  for (const Face& f : faces) {
    const Triangle t = triangle(points, f);
    if (turn(t[0], t[1], t[2]) <= 0) wrong << "a face that is not positive at " << t[0].x << " " << t[0].y << "; ";
    triangles.push_back(t);
    boxes.push_back(box_of(t));
  }
  std::vector<std::size_t> order(faces.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t s, std::size_t t) { return boxes[s].xmin < boxes[t].xmin; });
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size() && boxes[order[j]].xmin <= boxes[order[i]].xmax; ++j)
      if (const Triangle &s = triangles[order[i]], &t = triangles[order[j]];
          interiors_may_meet(boxes[order[i]], boxes[order[j]]) && interiors_meet(s, t))
        wrong << "faces overlap at " << s[0].x << " " << s[0].y << " and " << t[0].x << " " << t[0].y << "; ";
  return wrong.str();
}

PlanMesh plan_mesh(const Tin& tin) {
  PlanMesh mesh;
  for (const Point& p : tin.vertices) mesh.points.push_back(plan(p));
  std::sort(mesh.points.begin(), mesh.points.end(), before);
  mesh.points.erase(std::unique(mesh.points.begin(), mesh.points.end()), mesh.points.end());
  for (std::size_t f = 0; f < tin.faces.size(); ++f) {
    if (is_wall(tin, tin.faces[f])) continue;
    Face face;
    for (int k = 0; k < 3; ++k)
      face[k] = static_cast<Index>(
          std::lower_bound(mesh.points.begin(), mesh.points.end(), plan(tin.vertices[tin.faces[f][k]]), before) -
          mesh.points.begin());
    mesh.faces.push_back(face);
    mesh.face_in_tin.push_back(static_cast<Index>(f));
  }
  return mesh;
}

std::vector<std::pair<Index, Index>> border_of(std::span<const Face> faces) {
  const std::vector<std::uint64_t> edges = directed_edges(faces);
  std::vector<std::pair<Index, Index>> border;
  for (const std::uint64_t e : edges)
    if (!std::binary_search(edges.begin(), edges.end(), reversed(e)))
      border.emplace_back(static_cast<Index>(e >> 32), static_cast<Index>(e & 0xffffffff));
  return border;
}

}  // namespace terrane::support
