// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/arrangement.hpp"

#include <algorithm>
#include <string>

#include "core/crossing_point.hpp"
#include "core/edge_walk.hpp"
#include "core/error.hpp"
#include "core/exact_place.hpp"
#include "core/heights.hpp"
#include "core/junctions.hpp"
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
    take(std::move(walked));
  }

  void take(std::vector<Walked> walked) {
    Walked& all = walked[0];
    out_.first_corner = out_.first_crossing + static_cast<Index>(all.node_of_crossing.size());
    out_.lines[0] = {std::move(all.first), std::move(all.nodes)};
    out_.lines[0].first.push_back(static_cast<Index>(out_.lines[0].nodes.size()));
    out_.under = std::move(all.under);
    out_.vertex_of_node = std::move(all.vertex_of_node);
    along_b_ = std::move(all.along_b);
    out_.node_of_crossing = std::move(all.node_of_crossing);
    out_.points = std::move(all.points);
    for (int m = 0; m < 2; ++m) out_.heights[m] = std::move(all.heights[m]);
    place_in_lines_[0].assign(places(0), none);
    place_in_lines_[1].assign(places(1), none);
    out_.covered.assign(mesh(1).edges(), 0);
    for (const Walked& w : walked) {
      for (const auto& [place, node] : w.touched) place_in_lines_[1][place] = node;
      for (const Index e : w.covered) out_.covered[e] = 1;
    }
  }

  /// Sorts what lies on each edge of B along it: by a parameter in single precision, exactly where that cannot
  /// tell.
  void fill_lines_of_b() {
    const CompletedMesh& b = mesh(1);
    const Index edges = b.edges();
    Array<Index>& first = out_.lines[1].first;
    Array<Index> filled(edges, 0);
    // Every thread goes through all that lies on edges and takes what belongs to its own.
    const std::size_t chunk = chunk_for(context_, edges);
    parallel_for(context_, edges, chunk, [&](std::size_t begin, std::size_t end) {
      const auto mine = [&](Index e) { return static_cast<std::size_t>(e) - begin < end - begin; };
      for (const Node node : out_.lines[0].nodes)
        if (node.crossing() && mine(node.index())) ++filled[node.index()];
      each_place_on_edge([&](Index, Index h) {
        if (const Index e = b.edge_of(h); mine(e)) ++filled[e];
      });
    });
    first.resize(edges + 1);
    first[0] = 0;
    for (Index e = 0; e < edges; ++e) {
      first[e + 1] = first[e] + filled[e] + 2;
      filled[e] = first[e] + 1;
    }
    Array<Node>& nodes = out_.lines[1].nodes;
    nodes.resize(first[edges]);
    keys_.resize(first[edges] - 2 * static_cast<std::size_t>(edges));
    parallel_for(context_, edges, chunk, [&](std::size_t begin, std::size_t end) {
      const auto mine = [&](Index e) { return static_cast<std::size_t>(e) - begin < end - begin; };
      const auto put = [&](Index e, Node node, float how_far) {
        const Index at = filled[e]++;
        nodes[at] = node;
        key(e, at) = how_far;
      };
      const float* along = along_b_.data();
      for (std::size_t i = 0; i < out_.lines[0].nodes.size(); ++i) {
        const Node node = out_.lines[0].nodes[i];
        if (!node.crossing()) continue;
        if (mine(node.index())) put(node.index(), Node(node.kind(), static_cast<Index>(i)), *along);
        ++along;
      }
      each_place_on_edge([&](Index place, Index h) {
        const Index e = b.edge_of(h);
        if (!mine(e)) return;
        const Point2 o = b.at(b.origin(h)), t = b.at(b.target(h)), p = mesh(0).at(place);
        put(e, Node(Node::junction, place),  // by its place for now
            static_cast<float>(by_x(o, t) ? (p.x - o.x) / (t.x - o.x) : (p.y - o.y) / (t.y - o.y)));
      });
    });
    along_b_ = {};
    std::vector<double> moves((edges + chunk - 1) / chunk, 0);
    parallel_for(context_, edges, chunk, [&](std::size_t begin, std::size_t end) {
      double move = 0;
      for (std::size_t e = begin; e < end; ++e) sort_line(static_cast<Index>(e), move);
      moves[begin / chunk] = move;
    });
    out_.max_move = *std::max_element(moves.begin(), moves.end());
    keys_ = {};
  }

  /// How far along edge e of B the node `at` of its line lies, about; ends have none.
  float& key(Index e, Index at) { return keys_[static_cast<std::size_t>(at) - 2 * static_cast<std::size_t>(e) - 1]; }

  /// visit(place, half-edge of B) for every place of A inside an edge of B.
  template <class Visit>
  void each_place_on_edge(Visit&& visit) const {
    for (Index i = 0; i < places(0); ++i)
      if (const Location& where = out_.location[0][i]; where.kind == Location::edge) visit(i, where.index);
  }

  static bool by_x(Point2 o, Point2 t) { return std::fabs(t.x - o.x) >= std::fabs(t.y - o.y); }

  Node end_node(int m, Index h, Index place) const {
    const Index junction = out_.junction_of[m][place];
    return junction != none ? Node(Node::junction, junction) : Node(Node::end, h);
  }

  /// `move` becomes the larger of itself and the bound of the rounding on this edge.
  void sort_line(Index e, double& move) {
    const CompletedMesh& b = mesh(1);
    Array<Node>& nodes = out_.lines[1].nodes;
    const Index begin = out_.lines[1].first[e] + 1, end = out_.lines[1].first[e + 1] - 1;
    const Index h = b.half[e];
    nodes[begin - 1] = end_node(1, b.twin(h), b.origin(h));
    nodes[end] = end_node(1, h, b.target(h));
    if (begin == end) return;
    if (b.sides[e] > 0) move = larger_bound(move, b.at(b.origin(h)), b.at(b.target(h)));
    for (Index i = begin + 1; i < end; ++i) {  // insertion: a handful each, mostly in order
      const Node node = nodes[i];
      const float own = key(e, i);
      Index j = i;
      for (; j > begin; --j) {
        const float before = key(e, j - 1);
        const bool less = std::fabs(own - before) > std::max(5e-7f * std::max(own, before), 1e-30f)
                              ? own < before
                              : exact_key(e, node) < exact_key(e, nodes[j - 1]);
        if (!less) break;
        nodes[j] = nodes[j - 1];
        key(e, j) = before;
      }
      nodes[j] = node;
      key(e, j) = own;
    }
    for (Index i = begin; i < end; ++i) {
      if (nodes[i].crossing()) {
        out_.lines[0].nodes[nodes[i].index()] = Node(nodes[i].kind(), i);
      } else {
        place_in_lines_[0][nodes[i].index()] = i;
        nodes[i] = Node(Node::junction, out_.junction_of[0][nodes[i].index()]);
      }
    }
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
  Array<float> along_b_;  // of crossings in the order of A's lines
  Array<float> keys_;
  Array<Index> place_in_lines_[2];  // of a place of m inside an edge of the other mesh: its node there
};

}  // namespace

std::array<Index, 2> Arrangement::crossing_edges(Index vertex) const {
  const Index on_a = node_of_crossing[vertex - first_crossing];
  return {line_of(lines[0], on_a), line_of(lines[1], lines[0].nodes[on_a].index())};
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
  const auto [ea, eb] = arrangement.crossing_edges(vertex);
  const CompletedMesh &a = *arrangement.mesh[0], &b = *arrangement.mesh[1];
  const Index ha = a.half[ea], hb = b.half[eb];
  return {ExactPlace::crossing, a.at(a.origin(ha)), a.at(a.target(ha)), b.at(b.origin(hb)), b.at(b.target(hb))};
}

Arrangement arrange(const CompletedMesh& a, const CompletedMesh& b, Array<Location> b_in_a, Refinement refinement,
                    Context& context) {
  return Builder(a, b, refinement, context).build(std::move(b_in_a));
}

}  // namespace terrane
