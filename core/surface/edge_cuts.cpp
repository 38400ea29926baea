// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/surface/edge_cuts.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/plan/place_order.hpp"
#include "core/predicates.hpp"
#include "core/rounding/exterior.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

/// Up to two vertices on an edge, in the order along it as its first half-edge runs.
struct OnEdge {
  Index count = 0;
  Index vertices[2] = {none, none};
};

/// A corner or cut vertex on the boundary of a face, and the lines it lies on: bits 0 to 2 the sides, bit 3 the chord.
struct Node {
  Index vertex;
  unsigned lines;
};

double quality(const Array<Point2>& points, Index a, Index b, Index c) {
  const Point2 p = points[a], q = points[b], r = points[c];
  const auto square = [](Point2 u, Point2 v) { return (u.x - v.x) * (u.x - v.x) + (u.y - v.y) * (u.y - v.y); };
  const double longest = std::max({square(p, q), square(q, r), square(r, p)});
  return longest > 0 ? ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x)) / longest : 0;
}

class Cutter {
 public:
  Cutter(CutMesh& cut, const std::vector<EdgeCut>& cuts, Chords chords) : cut_(cut), cuts_(cuts), chords_(chords) {}

  void run() {
    make_vertices();
    const Index count = static_cast<Index>(cut_.mesh.faces.size());
    for (Index f = 0; f < count; ++f) split(f);
  }

 private:
  Index twin_half_edge(Index half) const {
    const Index f = half / 3, g = cut_.mesh.neighbours[f][half % 3];
    if (g == none) return none;
    for (int k = 0; k < 3; ++k)
      if (cut_.mesh.neighbours[g][k] == f && cut_.mesh.faces[g][(k + 1) % 3] == cut_.mesh.faces[f][(half + 2) % 3])
        return 3 * g + k;
    assert(false && "neighbours disagree");
    return none;
  }

  void make_vertices() {
    PlanarMesh& mesh = cut_.mesh;
    cut_.first_made = static_cast<Index>(mesh.points.size());
    edge_of_.assign(3 * mesh.faces.size(), none);
    std::vector<std::pair<Index, Index>> order;  // (first half-edge, cut)
    for (std::size_t i = 0; i < cuts_.size(); ++i) {
      const Index half = 3 * cuts_[i].face + cuts_[i].side, twin = twin_half_edge(half);
      order.emplace_back(twin == none ? half : std::min(half, twin), static_cast<Index>(i));
    }
    std::sort(order.begin(), order.end());
    for (std::size_t i = 0; i < order.size();) {
      std::size_t end = i + 1;
      while (end < order.size() && order[end].first == order[i].first) ++end;
      add_edge(order[i].first, &order[i], end - i);
      i = end;
    }
  }

  void add_edge(Index half, const std::pair<Index, Index>* first, std::size_t count) {
    assert(count <= 2);
    const Face& face = cut_.mesh.faces[half / 3];
    const Index p = face[(half + 1) % 3], q = face[(half + 2) % 3];  // half % 3 and half agree modulo 3
    OnEdge on;
    double ratios[2][2];  // |value| at p and q
    for (std::size_t i = 0; i < count; ++i) {
      const EdgeCut& c = cuts_[first[i].second];
      const bool same = 3 * c.face + c.side == half;
      const double dp = same ? c.dp : c.dq, dq = same ? c.dq : c.dp;
      const int order = i == 0 ? 1 : compare_products(std::fabs(dp), ratios[0][1], ratios[0][0], std::fabs(dq));
      if (order == 0) {
        cut_.made.back().owners[1] = c.face;
        continue;
      }
      ratios[i][0] = std::fabs(dp), ratios[i][1] = std::fabs(dq);
      on.vertices[on.count++] = make_vertex(p, q, dp, dq, c.face);
      if (order < 0) std::swap(on.vertices[0], on.vertices[1]);
    }
    const Index edge = static_cast<Index>(edges_.size());
    edges_.push_back(on);
    edge_of_[half] = edge;
    if (const Index twin = twin_half_edge(half); twin != none) edge_of_[twin] = edge;
    first_half_.push_back(half);
  }

  Index make_vertex(Index p, Index q, double dp, double dq, Index owner) {
    PlanarMesh& mesh = cut_.mesh;
    if (!before(mesh.points[p], mesh.points[q])) std::swap(p, q), std::swap(dp, dq);
    cut_.made.push_back({p, q, dp, dq, {owner, none}});
    mesh.points.push_back(rounded(place(cut_.made.back())));
    return static_cast<Index>(mesh.points.size() - 1);
  }

 public:
  ExactPlace place(const CutVertex& v) const {
    ExactPlace place;
    place.kind = ExactPlace::ratio;
    place.p = cut_.mesh.points[v.p];
    place.q = cut_.mesh.points[v.q];
    place.dp = v.dp;
    place.dq = v.dq;
    return place;
  }

 private:
  void split(Index f) {
    const Face face = cut_.mesh.faces[f];
    if (edge_of_[3 * f] == none && edge_of_[3 * f + 1] == none && edge_of_[3 * f + 2] == none) return;
    std::vector<Node> nodes;
    for (int k = 0; k < 3; ++k) {
      nodes.push_back({face[k], 7u & ~(1u << k)});
      const int side = (k + 2) % 3;
      const Index edge = edge_of_[3 * f + side];
      if (edge == none) continue;
      const OnEdge& on = edges_[edge];
      const bool forwards = first_half_[edge] == 3 * f + side;
      for (Index i = 0; i < on.count; ++i) nodes.push_back({on.vertices[forwards ? i : on.count - 1 - i], 1u << side});
    }
    first_triangle_ = f;
    const auto [i, j] = chord(f, face, nodes);
    if (i == j) return triangulate(nodes, f);
    nodes[i].lines |= 8u, nodes[j].lines |= 8u;
    std::vector<Node> half(nodes.begin() + i, nodes.begin() + j + 1);
    triangulate(half, f);
    half.assign(nodes.begin() + j, nodes.end());
    half.insert(half.end(), nodes.begin(), nodes.begin() + i + 1);
    triangulate(half, f);
  }

  /// The two nodes that the face is divided between, or twice the same when it is not.
  std::pair<std::size_t, std::size_t> chord(Index f, const Face& face, const std::vector<Node>& nodes) const {
    if (chords_ == Chords::none) return {0, 0};
    std::vector<std::size_t> own;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (nodes[i].vertex < cut_.first_made) continue;
      const CutVertex& v = cut_.made[nodes[i].vertex - cut_.first_made];
      if (v.owners[0] == f || v.owners[1] == f) own.push_back(i);
    }
    if (own.empty()) return {0, 0};
    if (own.size() == 2) return {own[0], own[1]};
    int side = 0;
    while (nodes[own[0]].lines != 1u << side) ++side;
    std::size_t corner = 0;
    while (nodes[corner].vertex != face[side]) ++corner;
    return {std::min(corner, own[0]), std::max(corner, own[0])};
  }

  /// Cuts ears off a convex polygon with collinear nodes, the best-shaped first. Whether three nodes are collinear is
  /// known from the lines they lie on; rounded places only choose between right answers.
  void triangulate(std::vector<Node> polygon, Index label) {
    while (polygon.size() > 3) {
      std::size_t best = polygon.size();
      double best_quality = 0;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        if (!is_ear(polygon, i)) continue;
        const double q = ear_quality(polygon, i);
        const bool better =
            best == polygon.size() || q > best_quality ||
            (q == best_quality && before(cut_.mesh.points[polygon[i].vertex], cut_.mesh.points[polygon[best].vertex]));
        if (better) best = i, best_quality = q;
      }
      assert(best < polygon.size());
      const std::size_t n = polygon.size();
      emit({polygon[(best + n - 1) % n].vertex, polygon[best].vertex, polygon[(best + 1) % n].vertex}, label);
      polygon.erase(polygon.begin() + best);
    }
    emit({polygon[0].vertex, polygon[1].vertex, polygon[2].vertex}, label);
  }

  static bool is_ear(const std::vector<Node>& polygon, std::size_t i) {
    const std::size_t n = polygon.size();
    if (polygon[(i + n - 1) % n].lines & polygon[i].lines & polygon[(i + 1) % n].lines) return false;
    unsigned common = ~0u;
    for (std::size_t k = 0; k < n; ++k)
      if (k != i) common &= polygon[k].lines;
    return common == 0;
  }

  double ear_quality(const std::vector<Node>& polygon, std::size_t i) const {
    const std::size_t n = polygon.size();
    const auto at = [&](std::size_t k) { return polygon[(i + k) % n].vertex; };
    const double q = quality(cut_.mesh.points, at(n - 1), at(0), at(1));
    return n == 4 ? std::min(q, quality(cut_.mesh.points, at(1), at(2), at(3))) : q;
  }

  void emit(Face face, Index label) {
    if (first_triangle_ != none) {
      cut_.mesh.faces[first_triangle_] = face;
      first_triangle_ = none;
      return;
    }
    cut_.mesh.faces.push_back(face);
    cut_.mesh.labels.push_back(label);
  }

  CutMesh& cut_;
  const std::vector<EdgeCut>& cuts_;
  Chords chords_;
  std::vector<Index> edge_of_;  // half-edge -> edge with vertices on it
  std::vector<OnEdge> edges_;
  std::vector<Index> first_half_;  // the half-edge that an edge's vertices are ordered along
  Index first_triangle_ = none;    // where the first triangle of a split face goes
};

/// Does rounding turn a face over, or may it have moved the border? Then what lies beyond that, an ulp away perhaps,
/// has a say in where vertices can go.
bool may_pass_the_border(const PlanarMesh& mesh, Index first_made) {
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Face& c = mesh.faces[f];
    for (int k = 0; k < 3; ++k) {
      if (c[k] < first_made) continue;
      if (mesh.neighbours[f][(k + 1) % 3] == none || mesh.neighbours[f][(k + 2) % 3] == none) return true;
      if (orientation(mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]]) <= 0) return true;
    }
  }
  return false;
}

/// Leaves out dead faces and the exterior.
void drop_dead(PlanarMesh& mesh) {
  std::size_t n = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.faces[f][0] == none || mesh.labels[f] == none) continue;
    mesh.faces[n] = mesh.faces[f];
    mesh.labels[n++] = mesh.labels[f];
  }
  if (n == mesh.faces.size()) return;
  mesh.faces.resize(n);
  mesh.labels.resize(n);
}

}  // namespace

Rounded round_cuts(PlanarMesh& mesh, Index first_made, const std::function<ExactPlace(Index)>& place,
                   const std::function<double(Index label, Point2)>& distance, Context& context) {
  connect(mesh);
  // Rounding asks for exact places while it changes the mesh; the ends of the edges are input and stay where they are.
  const Index vertices = static_cast<Index>(mesh.points.size());
  const auto exact = [&](Index v) {
    if (v >= first_made && v < vertices) return place(v);
    ExactPlace at;
    at.p = mesh.points[v];
    return at;
  };
  const auto from_label = [&](Index label, Point2 p) { return label == none ? 0.0 : distance(label, p); };
  if (may_pass_the_border(mesh, first_made)) add_exterior(mesh, exact);
  Rounded rounded = round_and_verify(mesh, exact, context, farthest_corner(from_label));
  drop_dead(mesh);
  mesh.points.resize(vertices);
  rounded.merged_into.resize(vertices);
  connect(mesh);
  return rounded;
}

CutMesh cut_edges(PlanarMesh mesh, const std::vector<EdgeCut>& cuts, Chords chords, Context& context) {
  const Array<Face> before = mesh.faces;
  CutMesh cut;
  cut.mesh = std::move(mesh);
  cut.mesh.labels.resize(cut.mesh.faces.size());
  for (std::size_t f = 0; f < cut.mesh.faces.size(); ++f) cut.mesh.labels[f] = static_cast<Index>(f);
  Cutter cutter(cut, cuts, chords);
  cutter.run();
  const auto place = [&](Index v) { return cutter.place(cut.made[v - cut.first_made]); };
  const auto distance = [&](Index label, Point2 p) {
    const Face& c = before[label];
    return distance_to_triangle({cut.mesh.points[c[0]], cut.mesh.points[c[1]], cut.mesh.points[c[2]]}, p);
  };
  cut.rounded = round_cuts(cut.mesh, cut.first_made, place, distance, context);
  return cut;
}

bool is_on(const CutMesh& cut, const Face& face, Index v) {
  const auto corner = [&](Index c) { return c == face[0] || c == face[1] || c == face[2]; };
  if (v < cut.first_made) return corner(v);
  const CutVertex& made = cut.made[v - cut.first_made];
  return corner(made.p) && corner(made.q);
}

double value_on(const CutMesh& cut, const Array<Point2>& points, const Face& face, const double* values, Index v) {
  for (int k = 0; k < 3; ++k)
    if (face[k] == v) return values[k];
  if (v >= cut.first_made) {
    const CutVertex& made = cut.made[v - cut.first_made];
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const bool same = face[i] == made.p && face[j] == made.q;
      if (!same && !(face[i] == made.q && face[j] == made.p)) continue;
      const double zp = values[same ? i : j], zq = values[same ? j : i];
      const double t = made.dp / (made.dp - made.dq);
      return t <= 0.5 ? zp + t * (zq - zp) : zq + made.dq / (made.dp - made.dq) * (zq - zp);
    }
  }
  return height_on_triangle({points[face[0]], points[face[1]], points[face[2]]}, {values[0], values[1], values[2]},
                            cut.mesh.points[v]);
}

}  // namespace terrane
