// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/edge_walk.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/crossing_point.hpp"
#include "core/error.hpp"
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
        range_(range),
        most_(most),
        first_vertex_(range.first_vertex),
        vertex_count_(range.first_vertex) {}

  Walked run() {
    out_.first.reserve(range_.edges_to_come + 1);
    out_.first.resize(range_.end - range_.begin);
    // Terrain gives 2.5 crossings per edge; memory that is never touched costs nothing.
    grow_nodes(5 * static_cast<std::size_t>(range_.edges_to_come) + 64);
    grow_crossings(3 * static_cast<std::size_t>(range_.edges_to_come) + 64);
    for (Index e = range_.begin; e < range_.end; ++e) {
      if ((e & 0xFFFF) == 0) context_.stop_if_cancelled();
      if (node_count_ + 64 > node_room_) grow_nodes(2 * node_room_);
      out_.first[e - range_.begin] = static_cast<Index>(node_count_);
      start_line(e);
      if (!paste_ || a_.sides[e] < 2) follow(e);
      push(end_node(0, a_.half[e]));
      in_face(Arrangement::not_followed);
    }
    out_.nodes.resize(node_count_);
    out_.under.resize(node_count_);
    out_.vertex_of_node.resize(node_count_);
    out_.along_b.resize(crossing_count_);
    out_.node_of_crossing.resize(vertex_count_ - first_vertex_);
    out_.points.resize(vertex_count_ + box_corners);
    for (auto& z : out_.heights) z.resize(vertex_count_ + box_corners);
    return std::move(out_);
  }

 private:
  void grow_nodes(std::size_t room) {
    node_room_ = room;
    out_.nodes.resize(room);
    out_.under.resize(room);
    out_.vertex_of_node.resize(room);
  }
  void grow_crossings(std::size_t room) {
    crossing_room_ = room;
    out_.along_b.resize(room);
    out_.node_of_crossing.resize(room);
    out_.points.resize(first_vertex_ + room + box_corners);
    for (auto& z : out_.heights) z.resize(first_vertex_ + room + box_corners);
  }

  Node end_node(int m, Index h) const {
    const CompletedMesh& mesh = *arrangement_.mesh[m];
    const Index junction = arrangement_.junction_of[m][mesh.target(h)];
    return junction != none ? Node(Node::junction, junction) : Node(Node::end, h);
  }
  void push(Node node) {
    out_.vertex_of_node[node_count_] = none;
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

  bool ends_in(Index face) const {
    switch (to_.kind) {
      case Location::face:
        return to_.index == face;
      case Location::edge:
        return (to_.index >> 2) == face || (b_.twin(to_.index) != none && (b_.twin(to_.index) >> 2) == face);
      case Location::place:
        return b_.corner(4 * face) == to_.index || b_.corner(4 * face + 1) == to_.index ||
               b_.corner(4 * face + 2) == to_.index;
    }
    return false;
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

  /// The edge being followed, as numbers that stay in registers.
  struct Line {
    Point2 start, goal;
    double z[2];
    bool by_x;          // the longer coordinate
    double per_length;  // 1 / its extent
    bool leaves_trace;  // its crossings with real edges have a vertex

    double side(Point2 p) const { return area2_accurate(start, goal, p); }
    /// A's height at a place on the edge, from the nearer end.
    double height(Point2 p) const {
      const double u = std::clamp((by_x ? p.x - start.x : p.y - start.y) * per_length, 0.0, 1.0);
      const bool far = u > 0.5;
      return z[far] + (z[!far] - z[far]) * std::min(u, 1 - u);
    }
  };

  Line line_of(Index e) const {
    const Index u = a_.origin(a_.half[e]), w = a_.target(a_.half[e]);
    const Point2 start = a_.at(u), goal = a_.at(w);
    const double dx = goal.x - start.x, dy = goal.y - start.y;
    const bool by_x = std::fabs(dx) >= std::fabs(dy);
    return {start, goal, {a_.z[u], a_.z[w]}, by_x, 1 / (by_x ? dx : dy), paste_ ? a_.sides[e] == 1 : a_.sides[e] > 0};
  }

  void follow(Index e) {
    const Index u = a_.origin(a_.half[e]), w = a_.target(a_.half[e]);
    const Line line = line_of(e);
    const auto side = [&](Index place) { return line.side(b_.at(place)); };
    const Location from = arrangement_.location[0][u];
    to_ = arrangement_.location[0][w];

    Index at_place = none;  // the walk stands on this place of B
    Index exit = none;      // or is about to leave a face through this half-edge, whose origin is right and target left
    double right = 0, left = 0;
    // Having come into the face of g through g (which runs from left to right), where does the line leave it?
    const auto leave = [&](Index g) {
      const Index p = b_.apex(g);
      const double d = side(p);
      if (d == 0) at_place = p;
      const bool is_left = d > 0;  // as good as random, so no branch
      exit = is_left ? next_half(g) : prev_half(g);
      left = is_left ? d : left;
      right = is_left ? right : d;
    };
    if (from.kind == Location::place) {
      if (to_.kind == Location::place)
        if (const Index h = half_between(from.index, to_.index, a_.half[e]); h != none) return along_half(h);
      at_place = from.index;
    } else if (from.kind == Location::edge) {
      const Index h = from.index;
      const double o = side(b_.origin(h)), t = side(b_.target(h));
      if (o == 0) {  // along the edge
        const bool onward = ahead(line.start, b_.at(b_.target(h)), line.start, line.goal);
        along_half(onward ? h : b_.twin(h));
        if (to_.kind == Location::edge && to_.index == h) return;
        at_place = onward ? b_.target(h) : b_.origin(h);
      } else {
        const Index g = o < 0 ? b_.twin(h) : h;  // the side of the edge that lies ahead
        in_face(g >> 2);
        if (ends_in(g >> 2)) return;
        right = std::min(o, t), left = std::max(o, t);
        leave(g);
      }
    } else {
      const Index f = from.index;
      in_face(f);
      if (ends_in(f)) return;
      double d[3];
      for (int k = 0; k < 3; ++k) d[k] = side(b_.corner(4 * f + k));
      for (int k = 0; k < 3; ++k) {
        const int k1 = k == 2 ? 0 : k + 1;
        if (d[k] == 0 && d[k1] > 0) at_place = b_.corner(4 * f + k);
        if (d[k] < 0 && d[k1] > 0) exit = 4 * f + k, right = d[k], left = d[k1];
      }
    }

    for (;;) {
      if (node_count_ + 2 > node_room_) grow_nodes(2 * node_room_);
      if (at_place != none) {
        const Index v = at_place;
        at_place = none;
        if (to_.kind == Location::place && to_.index == v) return;
        if (!(from.kind == Location::place && from.index == v)) {
          out_.touched.push_back({v, static_cast<Index>(node_count_)});
          push(Node(Node::junction, arrangement_.junction_of[1][v]));
        }
        const Point2 V = b_.at(v);
        bool found = false;
        for (Index h = b_.out[v]; h != none && !found;) {
          const Index q = b_.target(h);
          const double dq = side(q);
          if (dq == 0 && ahead(V, b_.at(q), line.start, line.goal)) {
            along_half(h);
            if (to_.kind == Location::edge && to_.index == b_.half[b_.edge_of(h)]) return;
            at_place = q;
            found = true;
          } else if (dq < 0) {
            const double da = side(b_.apex(h));
            if (da > 0) {
              in_face(h >> 2);
              if (ends_in(h >> 2)) return;
              exit = next_half(h), right = dq, left = da;
              found = true;
            }
          }
          h = b_.rotate(h);
          if (h == b_.out[v]) break;
        }
        if (!found) throw Error(ErrorKind::internal, "walk", "an edge lost its way around a vertex");
        continue;
      }
      const Index g = b_.twin(exit);
      cross(line, exit, b_.real(exit >> 2) || b_.real(g >> 2), right, left);
      in_face(g >> 2);
      if (ends_in(g >> 2)) return;
      leave(g);
    }
  }

  void cross(const Line& line, Index exit, bool real, double right, double left) {
    if (crossing_count_ == crossing_room_) {
      if (crossing_count_ > most_) throw too_many_crossings(most_);
      grow_crossings(2 * crossing_room_);
    }
    if (left - right < tiny_area) {
      right = area2_magnified(line.start, line.goal, b_.at(b_.origin(exit)));
      left = area2_magnified(line.start, line.goal, b_.at(b_.target(exit)));
    }
    const Index edge = b_.edge(exit), eb = edge >> 1, against = edge & 1;
    const double to_r = std::fabs(against ? left : right), to_s = std::fabs(against ? right : left);
    // The nearer end of B's edge is s as often as r: picked without a branch.
    const bool far = to_r > to_s;
    const double t = std::min(to_r, to_s) / (to_r + to_s), along_b[2] = {t, 1 - t};
    out_.along_b[crossing_count_++] = static_cast<float>(along_b[far]);
    Index& vertex = out_.vertex_of_node[node_count_];
    const Index node = static_cast<Index>(node_count_);
    push(Node(static_cast<Node::Kind>(against), eb));  // leftward is 0, rightward 1
    if (!real || !line.leaves_trace) return;
    const Index ends[2] = {against ? b_.target(exit) : b_.origin(exit), against ? b_.origin(exit) : b_.target(exit)};
    const Index near = ends[far], beyond = ends[!far];
    const Point2 R = b_.at(near), S = b_.at(beyond);
    const Point2 at = crossing_point(line.start, line.goal, R, S, t);
    vertex = static_cast<Index>(vertex_count_);
    out_.points[vertex_count_] = at;
    out_.node_of_crossing[vertex_count_ - first_vertex_] = node;
    out_.heights[0][vertex_count_] = line.height(at);
    out_.heights[1][vertex_count_] = b_.z[near] + (b_.z[beyond] - b_.z[near]) * t;
    ++vertex_count_;
  }

  const Arrangement& arrangement_;
  const Context& context_;
  const CompletedMesh &a_, &b_;
  bool paste_;
  WalkRange range_;
  std::size_t most_;
  Walked out_;
  Index first_vertex_;
  std::size_t vertex_count_, node_count_ = 0, crossing_count_ = 0, node_room_ = 0, crossing_room_ = 0;
  Index ahead_of_a_ = 0;  // how far the last shared half-edge is numbered further in B
  Location to_;           // where the edge being followed ends
};

}  // namespace

Error too_many_crossings(std::size_t most) {
  return Error(ErrorKind::limit, "too-many-crossings",
               "the surfaces cross each other more than " + std::to_string(most) +
                   " times, far more than terrain does: long thin faces lie across each other; triangulate them anew");
}

WalkedOffset WalkedOffset::after(const Walked& walked) const {
  return {edges + static_cast<Index>(walked.first.size()), nodes + static_cast<Index>(walked.nodes.size()),
          vertices + static_cast<Index>(walked.node_of_crossing.size()), crossings + walked.along_b.size()};
}

void extend(Walked& all, const WalkedOffset& total, Index first_vertex) {
  all.first.resize(total.edges);
  all.nodes.resize(total.nodes);
  all.under.resize(total.nodes);
  all.vertex_of_node.resize(total.nodes);
  all.along_b.resize(total.crossings);
  all.node_of_crossing.resize(total.vertices);
  const std::size_t vertices = static_cast<std::size_t>(first_vertex) + total.vertices + box_corners;
  all.points.resize(vertices);
  for (auto& z : all.heights) z.resize(vertices);
}

void append(Walked& all, const WalkedOffset& at, Walked& more, Index first_vertex) {
  const auto moved = [](const Array<Index>& from, Array<Index>& to, Index offset, Index by) {
    for (std::size_t i = 0; i < from.size(); ++i) to[offset + i] = from[i] == none ? none : from[i] + by;
  };
  const Index vertices = first_vertex + at.vertices;
  moved(more.first, all.first, at.edges, at.nodes);
  moved(more.vertex_of_node, all.vertex_of_node, at.nodes, vertices);
  moved(more.node_of_crossing, all.node_of_crossing, at.vertices, at.nodes);
  std::copy(more.nodes.begin(), more.nodes.end(), all.nodes.begin() + at.nodes);
  std::copy(more.under.begin(), more.under.end(), all.under.begin() + at.nodes);
  std::copy(more.along_b.begin(), more.along_b.end(), all.along_b.begin() + static_cast<std::ptrdiff_t>(at.crossings));
  const std::size_t count = more.node_of_crossing.size();
  std::copy_n(more.points.begin(), count, all.points.begin() + vertices);
  for (int m = 0; m < 2; ++m) std::copy_n(more.heights[m].begin(), count, all.heights[m].begin() + vertices);
  for (auto& [place, node] : more.touched) node += at.nodes;
}

Walked walk_edges(const Arrangement& arrangement, Refinement refinement, const WalkRange& range, std::size_t most,
                  const Context& context) {
  return EdgeWalk(arrangement, refinement, range, most, context).run();
}

}  // namespace terrane
