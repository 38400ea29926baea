// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay/edge_walk.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "core/mesh/pages.hpp"
#include "core/plan/crossing_point.hpp"
#include "core/predicates.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

constexpr std::size_t box_corners = 4;  // room for the caller's last vertices

bool ahead(Point2 from, Point2 to, Point2 start, Point2 end) {  // of collinear points: from -> to runs as start -> end?
  if (start.x != end.x) return (to.x > from.x) == (end.x > start.x);
  return (to.y > from.y) == (end.y > start.y);
}

class EdgeWalk {
 public:
  EdgeWalk(const Arrangement& arrangement, Refinement refinement, const WalkRange& range, std::size_t most,
           const Context& context)
      : arrangement_(arrangement),
        context_(context),
        a_(*arrangement.mesh[0]),
        b_(*arrangement.mesh[1]),
        paste_(refinement == Refinement::paste),
        traced_(refinement == Refinement::outline ? 1 : 3),
        range_(range),
        most_(most),
        first_vertex_(range.first_vertex),
        vertex_count_(range.first_vertex),
        vertex_stop_(range.first_vertex) {}

  Walked run() {
    out_.first.reserve(range_.edges_to_come + 1);
    out_.first.resize(range_.end - range_.begin);
    // Terrain gives 2.5 crossings per edge; memory that is never touched costs nothing.
    resize_nodes(5 * static_cast<std::size_t>(range_.edges_to_come) + 64);
    resize_vertices(3 * static_cast<std::size_t>(range_.edges_to_come) + 64);
    out_.last_on_b.assign(b_.edges(), Node(Node::end, 0));
    for (Index e = range_.begin; e < range_.end; ++e) {
      if ((e & 0xFFFF) == 0) context_.stop_if_cancelled();
      if (node_count_ + 64 > node_stop_) open_nodes();
      out_.first[e - range_.begin] = static_cast<Index>(node_count_);
      start_line(e);
      if (!paste_ || a_.sides[e] < 2) follow(e);
      push(end_node(0, a_.half[e]));
      in_face(Arrangement::not_followed);
    }
    out_.nodes.resize(node_count_);
    out_.under.resize(node_count_);
    out_.vertex_of_node.resize(node_count_);
    out_.along_b.resize(node_count_);
    out_.vertices = static_cast<Index>(vertex_count_) - first_vertex_;
    out_.points.resize(vertex_count_ + box_corners);
    for (auto& z : out_.heights) z.resize(vertex_count_ + box_corners);
    return std::move(out_);
  }

 private:
  void open_nodes() {
    if (node_count_ > most_ + 2 * out_.first.size()) throw too_many_crossings(most_);
    if (node_count_ + 64 > out_.nodes.size()) resize_nodes(2 * out_.nodes.size());
    node_stop_ = next_stop(node_count_ + 64, out_.nodes.size());
    populate(out_.nodes, node_count_, node_stop_);
    populate(out_.under, node_count_, node_stop_);
    populate(out_.vertex_of_node, node_count_, node_stop_);
    populate(out_.along_b, node_count_, node_stop_);
  }
  void resize_nodes(std::size_t size) {
    out_.nodes.resize(size);
    out_.under.resize(size);
    out_.vertex_of_node.resize(size);
    out_.along_b.resize(size);
  }
  void open_vertices() {
    if (vertex_count_ + box_corners == out_.points.size()) resize_vertices(2 * (vertex_count_ - first_vertex_));
    const std::size_t room = out_.points.size() - box_corners - first_vertex_;
    vertex_stop_ = first_vertex_ + next_stop(vertex_count_ - first_vertex_, room);
    populate(out_.points, vertex_count_, vertex_stop_);
    for (auto& z : out_.heights) populate(z, vertex_count_, vertex_stop_);
  }
  void resize_vertices(std::size_t size) {
    out_.points.resize(first_vertex_ + size + box_corners);
    for (auto& z : out_.heights) z.resize(first_vertex_ + size + box_corners);
  }

  Node end_node(int m, Index h) const {
    const CompletedMesh& mesh = *arrangement_.mesh[m];
    const Index junction = arrangement_.junction_of[m][mesh.target(h)];
    return junction != none ? Node(Node::junction, junction) : Node(Node::end, h);
  }
  void push(Node node) {
    out_.vertex_of_node[node_count_] = ~static_cast<Index>(vertex_count_);
    out_.nodes[node_count_++] = node;
  }
  /// The piece that begins at the last node lies in a face of B, or along one of its half-edges.
  void in_face(Index face) { out_.under[node_count_ - 1] = face; }
  void along_half(Index h) {
    out_.under[node_count_ - 1] = ~h;
    out_.covered.push_back(b_.edge_of(h));
  }

  void start_line(Index e) {
    const Index h = a_.half[e], t = a_.twin(h);
    const Index junction = arrangement_.junction_of[0][a_.origin(h)];
    push(junction != none ? Node(Node::junction, junction) : Node(Node::end, t));
    in_face(Arrangement::not_followed);
  }

  /// Where the edge being followed ends: in either of two faces of B, or in any face with that corner.
  struct Goal {
    Index face[2] = {none, none}, place = none, edge = none;
  };
  Goal goal_at(const Location& where) const {
    if (where.kind == Location::place) return {{none, none}, where.index, none};
    if (where.kind == Location::face) return {{where.index, none}, none, none};
    return {{where.index >> 2, b_.left_face(b_.edge_of(where.index), 1)}, none, where.index};
  }
  bool ends_in(Index face) const {
    if (face == goal_.face[0] || face == goal_.face[1]) return true;
    if (goal_.place == none) return false;
    const Index* corner = b_.links[face].corner;
    return corner[0] == goal_.place || corner[1] == goal_.place || corner[2] == goal_.place;
  }

  /// The half-edge of B between two of its places, or none. `like`: the half-edge of A there; meshes that share faces
  /// mostly have them in one order.
  Index half_between(Index from, Index to, Index like) {
    const Index guess = like + ahead_of_a_;
    if (guess >= 0 && guess < 4 * b_.faces() && b_.origin(guess) == from && b_.target(guess) == to) return guess;
    const Index found = half_around(from, to);
    if (found != none) ahead_of_a_ = ((found >> 2) - (like >> 2)) * 4;
    return found;
  }
  Index half_around(Index from, Index to) const {
    const Index first = b_.out[from];
    for (Index h = first; h != none;) {
      if (b_.target(h) == to) return h;
      h = b_.rotate(h);
      if (h == first) break;
    }
    return none;
  }

  /// The half-edge of B that leaves a place and along or left of which, as `goes` says, the line goes on. Looked for
  /// both ways from the last one found there: of very many lines that leave one place most leave it beside the one
  /// before.
  template <class Goes>
  Index way_from(Index place, const Goes& goes) {
    const bool on_box = place >= b_.real_places();  // nothing goes all the way round there
    const Index first = last_way_ != none && !on_box && b_.origin(last_way_) == place ? last_way_ : b_.out[place];
    for (Index left = first, right = on_box ? none : first; left != none;) {
      if (goes(left)) return last_way_ = left;
      if (right != none) {
        right = next_half(b_.twin(right));
        if (right == left) break;
        if (goes(right)) return last_way_ = right;
      }
      left = b_.rotate(left);
      if (left == (on_box ? first : right)) break;
    }
    throw Error(ErrorKind::internal, "walk", "an edge lost its way around a vertex");
  }

  /// The edge being followed.
  struct Line {
    Point2 start, goal;
    double z[2];
    double per_x, per_y;  // 1 / the extent of the longer coordinate, and 0
    bool leaves_trace;    // its crossings with real edges have a vertex

    double side(Point2 p) const { return area2_accurate(start, goal, p); }
    /// A's height at a place on the edge, from the nearer end.
    double height(Point2 p) const {
      const double u = std::clamp((p.x - start.x) * per_x + (p.y - start.y) * per_y, 0.0, 1.0);
      const bool far = u > 0.5;
      return z[far] + (z[!far] - z[far]) * std::min(u, 1 - u);
    }
  };

  Line line_of(Index e) const {
    const Index u = a_.origin(a_.half[e]), w = a_.target(a_.half[e]);
    const Point2 start = a_.at(u), goal = a_.at(w);
    const double dx = goal.x - start.x, dy = goal.y - start.y;
    const bool by_x = std::fabs(dx) >= std::fabs(dy);
    const double per = 1 / (by_x ? dx : dy);
    return {start,          goal,           {a_.z[u], a_.z[w]},
            by_x ? per : 0, by_x ? 0 : per, paste_ ? a_.sides[e] == 1 : a_.sides[e] > 0};
  }

  /// A half-edge of B about to be crossed, from its right end (0) to its left one (1). What depends on which end is
  /// which is as good as random, so ends are picked by their numbers and not by branches.
  struct Gate {
    Index half;
    Index place[2];
    Point2 at[2];
    double side[2];  // of the line: negative, positive
  };
  Gate gate(Index h, double right, double left) const {
    const Index r = b_.origin(h), l = b_.target(h);
    return {h, {r, l}, {b_.at(r), b_.at(l)}, {right, left}};
  }

  void follow(Index e) {
    const Index u = a_.origin(a_.half[e]), w = a_.target(a_.half[e]);
    const Line line = line_of(e);
    const auto side = [&](Index place) { return line.side(b_.at(place)); };
    const Location from = arrangement_.location[0][u], to = arrangement_.location[0][w];
    goal_ = goal_at(to);

    Index at_place = none;  // the walk stands on this place of B
    Gate exit{};            // or is about to leave a face
    // Having come into the face of g through g, with the ends that `exit` has, where does the line leave it?
    const auto leave = [&](Index g) {
      const Index p = b_.apex(g);
      const Point2 P = b_.at(p);
      const double d = line.side(P);
      if (d == 0) at_place = p;
      const bool is_left = d > 0;
      exit.half = (g & ~3) | (18 >> is_left >> 2 * (g & 3) & 3);  // the next half-edge where left, else the one before
      exit.place[is_left] = p, exit.at[is_left] = P, exit.side[is_left] = d;
    };
    if (from.kind == Location::place) {
      if (to.kind == Location::place)
        if (const Index h = half_between(from.index, to.index, a_.half[e]); h != none) return along_half(h);
      at_place = from.index;
    } else if (from.kind == Location::edge) {
      const Index h = from.index;
      const double o = side(b_.origin(h)), t = side(b_.target(h));
      if (o == 0) {  // along the edge
        const bool onward = ahead(line.start, b_.at(b_.target(h)), line.start, line.goal);
        along_half(onward ? h : b_.twin(h));
        if (goal_.edge == h) return;
        at_place = onward ? b_.target(h) : b_.origin(h);
      } else {
        const Index g = o < 0 ? b_.twin(h) : h;  // the side of the edge that lies ahead
        in_face(g >> 2);
        if (ends_in(g >> 2)) return;
        exit = gate(o < 0 ? h : b_.twin(h), std::min(o, t), std::max(o, t));
        leave(g);
      }
    } else {
      const Index f = from.index;
      in_face(f);
      if (ends_in(f)) return;
      double d[3];
      for (int k = 0; k < 3; ++k) d[k] = side(b_.corner(4 * f + k));
      if (d[0] == 0 || d[1] == 0 || d[2] == 0)
        for (int k = 0; k < 3; ++k)
          if (d[k] == 0 && d[(k + 1) % 3] > 0) at_place = b_.corner(4 * f + k);
      if (at_place == none) {  // from a corner on the right to one on the left
        static constexpr Index first_right[8] = {none, 0, 1, 1, 2, 0, 2, none};
        const Index k = first_right[(d[0] < 0) + 2 * (d[1] < 0) + 4 * (d[2] < 0)];
        exit = gate(4 * f + k, d[k], d[k == 2 ? 0 : k + 1]);
      }
    }

    for (;;) {
      if (node_count_ + 2 > node_stop_) open_nodes();
      if (at_place != none) {
        const Index v = at_place;
        at_place = none;
        if (goal_.place == v) return;
        if (!(from.kind == Location::place && from.index == v)) {
          out_.touched.push_back({v, static_cast<Index>(node_count_)});
          push(Node(Node::junction, arrangement_.junction_of[1][v]));
        }
        const Point2 V = b_.at(v);
        double dq = 0, da = 0;
        const Index h = way_from(v, [&](Index h) {
          dq = side(b_.target(h));
          if (dq == 0) return ahead(V, b_.at(b_.target(h)), line.start, line.goal);
          return dq < 0 && (da = side(b_.apex(h))) > 0;
        });
        if (dq == 0) {
          along_half(h);
          if (goal_.edge == b_.half[b_.edge_of(h)]) return;
          at_place = b_.target(h);
        } else {
          in_face(h >> 2);
          if (ends_in(h >> 2)) return;
          exit = gate(next_half(h), dq, da);
        }
        continue;
      }
      const Index g = cross(line, exit);
      in_face(g >> 2);
      if (ends_in(g >> 2)) return;
      leave(g);
    }
  }

  /// Returns the half-edge on the other side.
  Index cross(const Line& line, const Gate& gate) {
    if (vertex_count_ == vertex_stop_) open_vertices();
    const LinkedFace& face = b_.links[gate.half >> 2];
    const Index g = face.twin[gate.half & 3], edge = face.edge[gate.half & 3], against = edge & 1;
    // From the nearer end; halfway from the edge's origin, which is its right end unless it runs against this
    // half-edge.
    double to_right = -gate.side[0], to_left = gate.side[1];
    if (to_right + to_left < tiny_area) {
      to_right = -area2_magnified(line.start, line.goal, gate.at[0]);
      to_left = area2_magnified(line.start, line.goal, gate.at[1]);
    }
    const Index near = (to_right > to_left) | ((to_right == to_left) & against);
    const double t = std::min(to_right, to_left) / (to_right + to_left), along_b[2] = {t, 1 - t};
    const std::size_t node = node_count_;
    out_.along_b[node] = static_cast<float>(along_b[near ^ against]);
    const Node of_b(static_cast<Node::Kind>(against), static_cast<Index>(node));  // leftward is 0, rightward 1
    push(std::exchange(out_.last_on_b[edge >> 1], of_b));
    const int real = static_cast<int>(b_.real(gate.half >> 2)) + static_cast<int>(b_.real(g >> 2));
    if (!line.leaves_trace || !(real & traced_)) return g;
    const Point2 at = crossing_point(line.start, line.goal, gate.at[near], gate.at[1 - near], t);
    const double z = b_.z[gate.place[near]];
    const std::size_t v = vertex_count_++;
    out_.vertex_of_node[node] = static_cast<Index>(v);
    out_.points[v] = at;
    out_.heights[0][v] = line.height(at);
    out_.heights[1][v] = z + (b_.z[gate.place[1 - near]] - z) * t;
    return g;
  }

  const Arrangement& arrangement_;
  const Context& context_;
  const CompletedMesh &a_, &b_;
  bool paste_;
  int traced_;  // edges of B with as many real sides leave a trace: bit 0 one, bit 1 two
  WalkRange range_;
  std::size_t most_;
  Walked out_;
  Index first_vertex_;
  std::size_t vertex_count_, vertex_stop_, node_count_ = 0, node_stop_ = 0;
  Index ahead_of_a_ = 0;  // how far the last shared half-edge is numbered further in B
  Index last_way_ = none;
  Goal goal_;  // of the edge being followed
};

}  // namespace

Error too_many_crossings(std::size_t most) {
  return Error(ErrorKind::limit, "too-many-crossings",
               "the surfaces cross each other more than " + std::to_string(most) +
                   " times, far more than terrain does: long thin faces lie across each other; triangulate them anew");
}

WalkedOffset WalkedOffset::after(const Walked& walked) const {
  return {edges + static_cast<Index>(walked.first.size()), nodes + static_cast<Index>(walked.nodes.size()),
          vertices + walked.vertices, crossings + walked.nodes.size() - 2 * walked.first.size()};
}

void extend(Walked& all, const WalkedOffset& total, Index first_vertex) {
  all.first.resize(total.edges);
  all.nodes.resize(total.nodes);
  all.under.resize(total.nodes);
  all.vertex_of_node.resize(total.nodes);
  all.along_b.resize(total.nodes);
  all.vertices = total.vertices;
  const std::size_t vertices = static_cast<std::size_t>(first_vertex) + total.vertices + box_corners;
  all.points.resize(vertices);
  for (auto& z : all.heights) z.resize(vertices);
}

void append(Walked& all, const WalkedOffset& at, Walked& more, Index first_vertex, int part) {
  const auto moved = [](const Array<Index>& from, Array<Index>& to, Index offset, Index by) {
    for (std::size_t i = 0; i < from.size(); ++i) to[offset + i] = from[i] < 0 ? from[i] - by : from[i] + by;
  };
  const Index vertices = first_vertex + at.vertices;
  if (part == 0) {
    moved(more.first, all.first, at.edges, at.nodes);
    std::copy(more.nodes.begin(), more.nodes.end(), all.nodes.begin() + at.nodes);
    std::copy(more.under.begin(), more.under.end(), all.under.begin() + at.nodes);
    for (auto& [place, node] : more.touched) node += at.nodes;
  } else if (part == 1) {
    moved(more.vertex_of_node, all.vertex_of_node, at.nodes, vertices);
    std::copy(more.along_b.begin(), more.along_b.end(), all.along_b.begin() + at.nodes);
  } else if (part == 2) {
    std::copy_n(more.points.begin(), more.vertices, all.points.begin() + vertices);
  } else {
    for (int m = 0; m < 2; ++m) std::copy_n(more.heights[m].begin(), more.vertices, all.heights[m].begin() + vertices);
  }
}

Walked walk_edges(const Arrangement& arrangement, Refinement refinement, const WalkRange& range, std::size_t most,
                  const Context& context) {
  return EdgeWalk(arrangement, refinement, range, most, context).run();
}

}  // namespace terrane
