// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay/arrangement.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "core/plan/crossing_point.hpp"
#include "core/overlay/edge_walk.hpp"
#include "core/plan/exact_point.hpp"
#include "core/overlay/heights.hpp"
#include "core/overlay/junctions.hpp"
#include "core/parallel.hpp"

namespace terrane {
namespace {

/// The edge whose line a node is part of.
Index line_of(const Lines& lines, Index node) {
  return static_cast<Index>(std::upper_bound(lines.first.begin(), lines.first.end(), node) - lines.first.begin() - 1);
}

class Builder {
 public:
  Builder(const CompletedMesh& a, const CompletedMesh& b, Refinement refinement, Context& context)
      : refinement_(refinement), context_(context) {
    out_.mesh[0] = &a, out_.mesh[1] = &b;
  }

  Arrangement build(Array<Location> b_in_a) {
    out_.location[1] = std::move(b_in_a);
    locate_a();
    number_places();
    number_junctions();
    context_.progress("overlay", 0.2);
    walk();
    place_vertices(out_, context_);
    context_.progress("overlay", 0.35);
    fill_lines_of_b();
    add_corners();
    join_spokes(out_, place_in_lines_);
    context_.progress("overlay", 0.45);
    return std::move(out_);
  }

 private:
  const CompletedMesh& mesh(int m) const { return *out_.mesh[m]; }
  Index places(int m) const { return static_cast<Index>(mesh(m).places.size()); }

  void locate_a() {
    out_.location[0].assign(places(0), {});
    for (Index j = 0; j < places(1); ++j)
      if (const Location& where = out_.location[1][j]; where.kind == Location::place)
        out_.location[0][where.index] = {Location::place, j};
    locate_places(mesh(0), mesh(1), out_.location[0], context_);
  }

  /// Does a place of B leave a trace? In a paste only those outside A and on its border do.
  bool kept(const Location& in_a) const {
    if (refinement_ != Refinement::paste) return true;
    if (in_a.kind == Location::face) return !mesh(0).real(in_a.index);
    return mesh(0).sides[mesh(0).edge_of(in_a.index)] < 2;
  }

  void number_places() {
    Index next = 0;
    for (int m = 0; m < 2; ++m) out_.number[m].assign(places(m), none);
    const auto add = [&](int m, Index place) {
      out_.number[m][place] = next++;
      out_.place_of_vertex.push_back(place);
    };
    out_.place_of_vertex.reserve(places(0) + places(1));
    for (Index i = 0; i < mesh(0).real_places(); ++i) add(0, i);
    out_.first_b = next;
    for (Index j = 0; j < mesh(1).real_places(); ++j) {
      const Location& where = out_.location[1][j];
      if (where.kind == Location::place)
        out_.number[1][j] = out_.number[0][where.index];
      else if (kept(where))
        add(1, j);
    }
    out_.first_crossing = next;
  }

  void number_junctions() {
    Index next = 0;
    for (int m = 0; m < 2; ++m) out_.junction_of[m].assign(places(m), none);
    for (Index i = 0; i < places(0); ++i) {
      const Location& where = out_.location[0][i];
      if (where.kind == Location::face) continue;
      if (where.kind == Location::place) out_.junction_of[1][where.index] = next;
      out_.junction_of[0][i] = next++;
    }
    for (Index j = 0; j < places(1); ++j)
      if (out_.location[1][j].kind == Location::edge) out_.junction_of[1][j] = next++;
    out_.vertex_of_junction.assign(next, none);
    for (int m = 0; m < 2; ++m)
      for (Index i = 0; i < places(m); ++i)
        if (const Index j = out_.junction_of[m][i]; j != none) out_.vertex_of_junction[j] = out_.number[m][i];
  }

  /// Follows A's edges, a range per thread. What the first one found is extended by what the others did.
  void walk() {
    // Terrain gives 4 crossings per place. Slivers across slivers can give the square of their number, which no memory
    // holds; the second bound keeps the numbers of nodes within 30 bits.
    const std::size_t all_places = static_cast<std::size_t>(places(0)) + static_cast<std::size_t>(places(1));
    const std::size_t ends = 2 * static_cast<std::size_t>(std::max(mesh(0).edges(), mesh(1).edges()));
    const std::size_t numbers = (std::size_t{1} << 30) - 1;
    const std::size_t most = std::min(10'000'000 + 32 * all_places, numbers - std::min(numbers, ends + all_places));
    const Index edges = mesh(0).edges();
    const std::size_t chunk = chunk_for(context_, edges), ranges = (edges + chunk - 1) / chunk;
    std::vector<Walked> walked(ranges);
    parallel_for(context_, edges, chunk, [&](std::size_t begin, std::size_t end) {
      const std::size_t r = begin / chunk;
      walked[r] = walk_edges(out_, refinement_,
                             {static_cast<Index>(begin), static_cast<Index>(end), r == 0 ? out_.first_crossing : 0,
                              r == 0 ? edges : static_cast<Index>(end - begin)},
                             most, context_);
    });
    std::vector<WalkedOffset> offset(ranges + 1);
    for (std::size_t r = 0; r < ranges; ++r) {
      offset[r + 1] = offset[r].after(walked[r]);
      if (offset[r + 1].crossings > most) throw too_many_crossings(most);
    }
    Walked& all = walked[0];
    extend(all, offset[ranges], out_.first_crossing);
    parallel_tasks(context_, (ranges - 1) * walked_parts, [&](std::size_t i) {
      const std::size_t r = i / walked_parts + 1;
      append(all, offset[r], walked[r], out_.first_crossing, static_cast<int>(i % walked_parts));
    });
    take(std::move(walked), offset);
  }

  void take(std::vector<Walked> walked, const std::vector<WalkedOffset>& offset) {
    Walked& all = walked[0];
    out_.first_corner = out_.first_crossing + all.vertices;
    out_.lines[0] = {std::move(all.first), std::move(all.nodes)};
    out_.lines[0].first.push_back(static_cast<Index>(out_.lines[0].nodes.size()));
    out_.under = std::move(all.under);
    out_.vertex_of_node = std::move(all.vertex_of_node);
    along_b_ = std::move(all.along_b);
    out_.points = std::move(all.points);
    for (int m = 0; m < 2; ++m) out_.heights[m] = std::move(all.heights[m]);
    place_in_lines_[0].assign(places(0), none);
    place_in_lines_[1].assign(places(1), none);
    out_.covered.assign(mesh(1).edges(), 0);
    crossings_ = offset.back().crossings;
    for (std::size_t r = 0; r < walked.size(); ++r) {
      Walked& w = walked[r];
      last_on_b_.push_back(std::move(w.last_on_b));
      first_node_.push_back(offset[r].nodes);
      crossings_ -= w.touched.size();
      for (const auto& [place, node] : w.touched) place_in_lines_[1][place] = node;
      for (const Index e : w.covered) out_.covered[e] = 1;
    }
  }

  /// What lies inside an edge of B, as its line will have it; but a place of A by its number.
  struct OnEdge {
    Node node;
    float how_far;  // along the edge, about
  };

  /// Takes what lies on each edge of B out of its chains and sorts it along the edge: by a parameter in single
  /// precision, exactly where that cannot tell.
  void fill_lines_of_b() {
    const CompletedMesh& b = mesh(1);
    const Index edges = b.edges();
    const std::size_t inside = chain_places() + crossings_;
    const std::size_t chunk = chunk_for(context_, edges), ranges = (edges + chunk - 1) / chunk;
    std::vector<std::size_t> start(ranges + 1, 0);
    parallel_for(context_, (ranges - 1) * chunk, chunk, [&](std::size_t begin, std::size_t end) {
      std::size_t count = 0;
      for (std::size_t e = begin; e < end; ++e) each_on_edge(static_cast<Index>(e), [&](Node) { ++count; });
      start[begin / chunk + 1] = count + 2 * (end - begin);
    });
    for (std::size_t r = 1; r < start.size(); ++r) start[r] += start[r - 1];
    out_.lines[1].first.resize(edges + 1);
    out_.lines[1].first[edges] = static_cast<Index>(inside) + 2 * edges;
    out_.lines[1].nodes.resize(inside + 2 * static_cast<std::size_t>(edges));
    std::vector<double> moves(ranges, 0);
    parallel_for(context_, edges, chunk, [&](std::size_t begin, std::size_t end) {
      std::vector<OnEdge> found;
      auto at = static_cast<Index>(start[begin / chunk]);
      double move = 0;
      for (auto e = static_cast<Index>(begin); e < static_cast<Index>(end); ++e) {
        found.clear();
        each_on_edge(e, [&](Node node) {
          insert(e, {node, node.crossing() ? along_b_[node.index()] : how_far(e, node.index())}, found);
        });
        at = put_line(e, found, at);
        if (found.empty() || b.sides[e] == 0) continue;
        move = larger_bound(move, b.at(b.origin(b.half[e])), b.at(b.target(b.half[e])));
      }
      moves[begin / chunk] = move;
    });
    out_.max_move = *std::max_element(moves.begin(), moves.end());
    along_b_ = {};
    next_on_edge_ = {};
    last_on_b_.clear();
  }

  /// Hangs the places of A inside edges of B before what the first range found there; returns their number.
  std::size_t chain_places() {
    std::size_t count = 0;
    next_on_edge_.resize(places(0));
    for (Index i = 0; i < places(0); ++i) {
      const Location& where = out_.location[0][i];
      if (where.kind != Location::edge) continue;
      next_on_edge_[i] = std::exchange(last_on_b_[0][mesh(1).edge_of(where.index)], Node(Node::junction, i));
      ++count;
    }
    return count;
  }

  /// visit(node) for all that lies inside an edge of B, in no order.
  template <class Visit>
  void each_on_edge(Index e, Visit&& visit) const {
    for (std::size_t r = 0; r < last_on_b_.size(); ++r)
      for (Node last = last_on_b_[r][e]; last.kind() != Node::end;) {
        const Index i = last.index() + (last.crossing() ? first_node_[r] : 0);
        visit(Node(last.kind(), i));
        last = last.crossing() ? out_.lines[0].nodes[i] : next_on_edge_[i];
      }
  }

  /// How far along edge e of B a place of A lies, about.
  float how_far(Index e, Index place) const {
    const Index h = mesh(1).half[e];
    const Point2 o = mesh(1).at(mesh(1).origin(h)), t = mesh(1).at(mesh(1).target(h)), p = mesh(0).at(place);
    return static_cast<float>(by_x(o, t) ? (p.x - o.x) / (t.x - o.x) : (p.y - o.y) / (t.y - o.y));
  }

  static bool by_x(Point2 o, Point2 t) { return std::fabs(t.x - o.x) >= std::fabs(t.y - o.y); }

  Node end_node(int m, Index h, Index place) const {
    const Index junction = out_.junction_of[m][place];
    return junction != none ? Node(Node::junction, junction) : Node(Node::end, h);
  }

  /// Puts one more, of a handful mostly, in its place along edge e of B.
  void insert(Index e, const OnEdge& own, std::vector<OnEdge>& found) const {
    found.push_back(own);
    OnEdge* at = &found.back();
    for (OnEdge* const first = found.data(); at > first; --at) {
      const float before = at[-1].how_far;
      const bool less = std::fabs(own.how_far - before) > std::max(5e-7f * std::max(own.how_far, before), 1e-30f)
                            ? own.how_far < before
                            : exact_key(e, own.node) < exact_key(e, at[-1].node);
      if (!less) break;
      *at = at[-1];
    }
    *at = own;
  }

  /// Writes the line of an edge of B at a place among the nodes and tells A's nodes where theirs stand. Returns the
  /// place after it.
  Index put_line(Index e, const std::vector<OnEdge>& found, Index at) {
    const CompletedMesh& b = mesh(1);
    const Index h = b.half[e];
    Array<Node>& nodes = out_.lines[1].nodes;
    out_.lines[1].first[e] = at;
    nodes[at++] = end_node(1, b.twin(h), b.origin(h));
    for (const OnEdge& on : found) {
      const Index i = on.node.index();
      if (on.node.crossing()) {
        out_.lines[0].nodes[i] = Node(on.node.kind(), at);
        nodes[at++] = on.node;
      } else {
        place_in_lines_[0][i] = at;
        nodes[at++] = Node(Node::junction, out_.junction_of[0][i]);
      }
    }
    nodes[at++] = end_node(1, h, b.target(h));
    return at;
  }

  /// How far along edge e of B a node lies, exactly.
  ExactKernel::FT exact_key(Index e, Node node) const {
    using Number = ExactKernel::FT;
    const Index h = mesh(1).half[e];
    const Point2 o = mesh(1).at(mesh(1).origin(h)), t = mesh(1).at(mesh(1).target(h));
    if (node.kind() == Node::junction) {
      const Point2 p = mesh(0).at(node.index());
      return by_x(o, t) ? (Number(p.x) - o.x) / (Number(t.x) - o.x) : (Number(p.y) - o.y) / (Number(t.y) - o.y);
    }
    const Index of_a = mesh(0).half[line_of(out_.lines[0], node.index())];
    return exact_parameter(
        {ExactPlace::crossing, mesh(0).at(mesh(0).origin(of_a)), mesh(0).at(mesh(0).target(of_a)), o, t});
  }

  /// The corners of the box come last: they close the exterior and are dropped with it.
  void add_corners() {
    for (int m = 0; m < 2; ++m)
      for (Index k = 0; k < 4; ++k) {
        const Index place = mesh(m).real_places() + k;
        out_.number[m][place] = out_.first_corner + k;
        out_.vertex_of_junction[out_.junction_of[m][place]] = out_.first_corner + k;
        out_.points[out_.first_corner + k] = mesh(m).at(place);
        out_.heights[m][out_.first_corner + k] = mesh(m).z[place];
      }
  }

  Refinement refinement_;
  Context& context_;
  Arrangement out_;
  Array<float> along_b_;                // per node of A
  std::vector<Array<Node>> last_on_b_;  // see Walked; of each range
  std::vector<Index> first_node_;       // of each range among the nodes of A
  Array<Node> next_on_edge_;            // of a place of A inside an edge of B: the next in its chain
  std::size_t crossings_ = 0;
  Array<Index> place_in_lines_[2];  // of a place of m inside an edge of the other mesh: its node there
};

}  // namespace

Index Arrangement::node_of(Index vertex) const {
  const auto after = [](Index v, Index of_node) { return v < std::max(of_node, ~of_node); };
  const auto next = std::upper_bound(vertex_of_node.begin(), vertex_of_node.end(), vertex, after);
  return static_cast<Index>(next - vertex_of_node.begin()) - 1;
}

Index Arrangement::edge_through(int m, Index node_of_a) const {
  return line_of(lines[m], m == 0 ? node_of_a : lines[0].nodes[node_of_a].index());
}

bool Arrangement::shared(Index face_of_a) const {
  Index common = none;
  for (int k = 0; k < 3; ++k) {
    const Index e = mesh[0]->edge_of(4 * face_of_a + k), at = lines[0].first[e];
    if (lines[0].pieces(e) != 1 || under[at] >= 0) return false;
    const Index face = face_of_b(at, mesh[0]->against(4 * face_of_a + k));
    if (k > 0 && face != common) return false;
    common = face;
  }
  return common != none;
}

ExactPlace exact_place(const Arrangement& arrangement, Index vertex) {
  if (vertex < arrangement.first_crossing || vertex >= arrangement.first_corner) return {};
  const CompletedMesh &a = *arrangement.mesh[0], &b = *arrangement.mesh[1];
  const Index node = arrangement.node_of(vertex);
  const Index ha = a.half[arrangement.edge_through(0, node)], hb = b.half[arrangement.edge_through(1, node)];
  return {ExactPlace::crossing, a.at(a.origin(ha)), a.at(a.target(ha)), b.at(b.origin(hb)), b.at(b.target(hb))};
}

Arrangement arrange(const CompletedMesh& a, const CompletedMesh& b, Array<Location> b_in_a, Refinement refinement,
                    Context& context) {
  return Builder(a, b, refinement, context).build(std::move(b_in_a));
}

}  // namespace terrane
