// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/lattice/lattice_mesh.hpp"

#include <algorithm>
#include <cassert>
#include <deque>

namespace terrane {

namespace {

constexpr int next(int k) { return k == 2 ? 0 : k + 1; }
constexpr int previous(int k) { return k == 0 ? 2 : k - 1; }

int corner_of(const LatticeTriangle& t, Index v) { return t.v[0] == v ? 0 : t.v[1] == v ? 1 : 2; }
int side_to(const LatticeTriangle& t, Index neighbour) { return t.n[0] == neighbour ? 0 : t.n[1] == neighbour ? 1 : 2; }

template <class Wide>
bool in_circle_as(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d) {
  const Wide ax = a.x - d.x, ay = a.y - d.y, bx = b.x - d.x, by = b.y - d.y, cx = c.x - d.x, cy = c.y - d.y;
  return (ax * ax + ay * ay) * (bx * cy - by * cx) + (bx * bx + by * by) * (cx * ay - cy * ax) +
             (cx * cx + cy * cy) * (ax * by - ay * bx) >
         0;
}

}  // namespace

LatticeMesh::LatticeMesh(int width, int height)
    : points{{0, 0}, {width - 1, 0}, {width - 1, height - 1}, {0, height - 1}},
      triangles{{{0, 1, 2}, {none, 1, none}}, {{0, 2, 3}, {none, none, 0}}},
      // 12 m^4 must stay below 2^63.
      wide_(std::max(width, height) > 29'000) {}

bool LatticeMesh::in_circle(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d) const {
  return wide_ ? in_circle_as<__int128>(a, b, c, d) : in_circle_as<std::int64_t>(a, b, c, d);
}

void LatticeMesh::replace_neighbour(Index t, Index old, Index now) {
  if (t >= 0) triangles[t].n[side_to(triangles[t], old)] = now;
}

/// Turns the edge opposite corner k of t. Afterwards that corner is v[0] of both t and its neighbour, t the right one.
void LatticeMesh::flip(Index t, int k) {
  const LatticeTriangle old = triangles[t];
  const Index o = old.n[k];
  const LatticeTriangle across = triangles[o];
  const int q = side_to(across, t);
  const Index p = old.v[k], a = old.v[next(k)], b = old.v[previous(k)], d = across.v[q];
  const Index right = across.n[next(q)], left = across.n[previous(q)];
  triangles[t] = {{p, a, d}, {right, o, old.n[previous(k)]}};
  triangles[o] = {{p, d, b}, {left, old.n[next(k)], t}};
  replace_neighbour(right, o, t);
  replace_neighbour(old.n[next(k)], t, o);
}

/// Lawson's flips from the triangles around a new vertex.
void LatticeMesh::legalize() {
  while (!pending_.empty()) {
    const Index t = pending_.back();
    const Index o = triangles[t].n[0];
    if (o < 0) {
      pending_.pop_back();
      continue;
    }
    const auto& [p, a, b] = triangles[t].v;
    const Index d = triangles[o].v[side_to(triangles[o], t)];
    if (in_circle(points[p], points[a], points[b], points[d])) {
      flip(t, 0);
      pending_.push_back(o);
    } else {
      pending_.pop_back();
    }
  }
}

Index LatticeMesh::insert(LatticePoint p, Index t) {
  const LatticeTriangle old = triangles[t];
  const Index v = static_cast<Index>(points.size());
  points.push_back(p);
  const Index fresh = static_cast<Index>(triangles.size());
  int on_edge = -1;
  for (int k = 0; k < 3; ++k) {
    if (area2(points[old.v[next(k)]], points[old.v[previous(k)]], p) == 0) on_edge = k;
  }
  if (on_edge < 0) {
    const auto [a, b, c] = old.v;
    triangles[t] = {{v, a, b}, {old.n[2], fresh, fresh + 1}};
    triangles.push_back({{v, b, c}, {old.n[0], fresh + 1, t}});
    triangles.push_back({{v, c, a}, {old.n[1], t, fresh}});
    replace_neighbour(old.n[0], t, fresh);
    replace_neighbour(old.n[1], t, fresh + 1);
    pending_ = {t, fresh, fresh + 1};
    legalize();
    return t;
  }
  const int k = on_edge;
  const Index c = old.v[k], a = old.v[next(k)], b = old.v[previous(k)], o = old.n[k];
  const Index beyond_b = old.n[previous(k)], beyond_a = old.n[next(k)];
  triangles[t] = {{v, c, a}, {beyond_b, none, fresh}};
  triangles.push_back({{v, b, c}, {beyond_a, t, none}});
  replace_neighbour(beyond_a, t, fresh);
  pending_ = {t, fresh};
  if (o >= 0) {
    const LatticeTriangle across = triangles[o];
    const int q = side_to(across, t);
    const Index d = across.v[q], beyond_right = across.n[next(q)], beyond_left = across.n[previous(q)];
    triangles[o] = {{v, d, b}, {beyond_left, fresh, fresh + 1}};
    triangles.push_back({{v, a, d}, {beyond_right, o, t}});
    replace_neighbour(beyond_right, o, fresh + 1);
    triangles[t].n[1] = fresh + 1;
    triangles[fresh].n[2] = o;
    pending_.push_back(o);
    pending_.push_back(fresh + 1);
  }
  legalize();
  return t;
}

/// Walks from the hint to p; returns its vertex, a new one if there was none.
Index LatticeMesh::locate_or_insert(LatticePoint p, Index& hint) {
  for (Index t = hint;;) {
    const LatticeTriangle& triangle = triangles[t];
    int out = -1;
    for (int k = 0; k < 3 && out < 0; ++k) {
      if (area2(points[triangle.v[next(k)]], points[triangle.v[previous(k)]], p) < 0) out = k;
    }
    if (out >= 0) {
      t = triangle.n[out];
      assert(t != none);
      continue;
    }
    hint = t;
    for (const Index v : triangle.v) {
      if (points[v] == p) return v;
    }
    hint = insert(p, t);
    return static_cast<Index>(points.size() - 1);
  }
}

void LatticeMesh::index_vertices() {
  triangle_of_.assign(points.size(), none);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const Index v : triangles[t].v) triangle_of_[v] = static_cast<Index>(t);
  }
}

/// The triangle left of u -> v and the corner opposite that edge, or {none, 0}.
std::array<Index, 2> LatticeMesh::find_edge(Index u, Index v) const {
  const Index start = triangle_of_[u];
  for (const bool forward : {true, false}) {
    Index t = start;
    do {
      const int k = corner_of(triangles[t], u);
      if (triangles[t].v[next(k)] == v) return {t, previous(k)};
      t = triangles[t].n[forward ? next(k) : previous(k)];
    } while (t != none && t != start);
    if (t == start) break;
  }
  return {none, 0};
}

/// Makes u v an edge by turning the edges that cross it (Sloan 1993). False when it was one already.
bool LatticeMesh::enforce(Index u, Index v) {
  if (find_edge(u, v)[0] != none || find_edge(v, u)[0] != none) return false;
  const auto side = [&](Index w) { return area2(points[u], points[v], points[w]); };
  std::deque<LatticeEdge> crossing;
  Index t = none;
  const auto look = [&](Index s) {
    const int k = corner_of(triangles[s], u);
    if (side(triangles[s].v[next(k)]) < 0 && side(triangles[s].v[previous(k)]) > 0) t = s;
  };
  Index s = triangle_of_[u];
  do {
    look(s);
    s = triangles[s].n[next(corner_of(triangles[s], u))];
  } while (s != none && s != triangle_of_[u]);
  if (s == none) {
    for (s = triangle_of_[u]; s != none; s = triangles[s].n[previous(corner_of(triangles[s], u))]) look(s);
  }
  assert(t != none);
  for (int k = corner_of(triangles[t], u);;) {
    const Index right = triangles[t].v[next(k)], left = triangles[t].v[previous(k)];
    crossing.push_back({right, left});
    const Index o = triangles[t].n[k];
    const Index apex = triangles[o].v[side_to(triangles[o], t)];
    if (apex == v) break;
    t = o;
    k = corner_of(triangles[t], side(apex) > 0 ? left : right);
  }
  while (!crossing.empty()) {
    const auto [a, b] = crossing.front();
    crossing.pop_front();
    const auto [f, k] = find_edge(a, b);
    const Index p = triangles[f].v[k], o = triangles[f].n[k];
    const Index d = triangles[o].v[side_to(triangles[o], f)];
    if (area2(points[p], points[a], points[d]) <= 0 || area2(points[p], points[d], points[b]) <= 0) {
      crossing.push_back({a, b});
      continue;
    }
    flip(f, k);
    triangle_of_[p] = triangle_of_[a] = f;
    triangle_of_[d] = triangle_of_[b] = o;
    if (p == u || p == v || d == u || d == v) continue;
    const auto sp = side(p), sd = side(d);
    if (sp < 0 && sd > 0) crossing.push_back({p, d});
    if (sp > 0 && sd < 0) crossing.push_back({d, p});
  }
  return true;
}

void LatticeMesh::restore_delaunay(std::vector<std::array<Index, 2>> stack) {
  while (!stack.empty()) {
    const auto [t, k] = stack.back();
    stack.pop_back();
    const Index o = triangles[t].n[k];
    if (o < 0) continue;
    const auto& v = triangles[t].v;
    const Index d = triangles[o].v[side_to(triangles[o], t)];
    if (!in_circle(points[v[0]], points[v[1]], points[v[2]], points[d])) continue;
    flip(t, k);
    for (const Index changed : {t, o}) {
      stack.push_back({changed, 0});
      stack.push_back({changed, changed == t ? 2 : 1});
    }
  }
}

/// Drops all triangles that cannot be reached from the left of the border; border holds triangle and corner.
void LatticeMesh::keep_inside(const std::vector<std::array<Index, 2>>& border) {
  std::vector<Index> number(triangles.size(), none), stack;
  for (const auto& [t, k] : border) {
    replace_neighbour(triangles[t].n[k], t, none);
    triangles[t].n[k] = none;
  }
  for (const auto& [start, k] : border) {
    if (number[start] == none) stack.push_back(start);
    number[start] = 0;
    while (!stack.empty()) {
      const Index t = stack.back();
      stack.pop_back();
      for (const Index o : triangles[t].n) {
        if (o == none || number[o] != none) continue;
        number[o] = 0;
        stack.push_back(o);
      }
    }
  }
  Index count = 0;
  for (Index& n : number) {
    if (n != none) n = count++;
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (number[t] == none) continue;
    LatticeTriangle kept = triangles[t];
    for (Index& o : kept.n) o = o == none ? none : number[o];
    triangles[number[t]] = kept;
  }
  triangles.resize(count);
}

void LatticeMesh::cut_out(const std::vector<LatticePoint>& border, const std::vector<LatticeEdge>& edges) {
  // Every 2^k-th point first: long ordered runs of insertions would make vertices of high degree.
  std::vector<Index> vertex(border.size(), none);
  Index hint = 0;
  std::size_t stride = 1;
  while (stride < border.size()) stride *= 4;
  for (; stride > 0; stride /= 4) {
    for (std::size_t i = 0; i < border.size(); i += stride) {
      if (vertex[i] == none) vertex[i] = locate_or_insert(border[i], hint);
    }
  }
  index_vertices();
  bool enforced = false;
  for (const auto& [u, v] : edges) enforced = enforce(vertex[u], vertex[v]) || enforced;
  std::vector<std::array<Index, 2>> inside;
  inside.reserve(edges.size());
  for (const auto& [u, v] : edges) inside.push_back(find_edge(vertex[u], vertex[v]));
  keep_inside(inside);
  if (enforced) {
    std::vector<std::array<Index, 2>> all;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        if (triangles[t].n[k] > static_cast<Index>(t)) all.push_back({static_cast<Index>(t), k});
      }
    }
    restore_delaunay(std::move(all));
  }
  triangle_of_ = {};
}

}  // namespace terrane
