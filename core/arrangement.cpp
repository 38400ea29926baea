// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/arrangement.hpp"

#include <algorithm>
#include <atomic>
#include <string>

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
    std::vector<Index> partner(places(0), none);  // place of B on a place of A
    for (Index j = 0; j < places(1); ++j)
      if (const Location& where = out_.location[1][j]; where.kind == Location::place) partner[where.index] = j;
    out_.location[0] = locate_places(mesh(0), mesh(1), context_);
    for (Index i = 0; i < places(0); ++i)
      if (partner[i] != none) out_.location[0][i] = {Location::place, partner[i]};
  }

  /// Does a place of B leave a trace? In a paste only those outside A and on its border do.
  bool kept(const Location& in_a) const {
    if (refinement_ == Refinement::full) return true;
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

  /// Follows A's edges, a range per thread, and puts the ranges one after the other.
  void walk() {
    // Slivers across slivers can give the square of their number, which no memory holds; the second bound keeps the
    // numbers of nodes within 30 bits.
    const std::size_t all_places = static_cast<std::size_t>(places(0)) + static_cast<std::size_t>(places(1));
    const std::size_t most = std::min<std::size_t>(10'000'000 + 32 * all_places, 400'000'000);
    const Index edges = mesh(0).edges();
    const std::size_t chunk = chunk_for(context_, edges), ranges = (edges + chunk - 1) / chunk;
    place_in_lines_[0].assign(places(0), none);
    place_in_lines_[1].assign(places(1), none);
    out_.covered.assign(mesh(1).edges(), 0);
    if (ranges == 1) return take(walk_edges(out_, refinement_, 0, edges, out_.first_crossing, most, context_));
    std::vector<Walked> walked(ranges);
    parallel_for(context_, edges, chunk, [&](std::size_t begin, std::size_t end) {
      walked[begin / chunk] =
          walk_edges(out_, refinement_, static_cast<Index>(begin), static_cast<Index>(end), 0, most, context_);
    });
    struct Offset {
      Index edges = 0, nodes = 0, vertices = 0;
      std::size_t crossings = 0;
    };
    std::vector<Offset> offset(ranges + 1);
    offset[0].vertices = out_.first_crossing;
    for (std::size_t r = 0; r < ranges; ++r) {
      const Walked& w = walked[r];
      offset[r + 1] = {
          offset[r].edges + static_cast<Index>(w.first.size()), offset[r].nodes + static_cast<Index>(w.nodes.size()),
          offset[r].vertices + static_cast<Index>(w.node_of_crossing.size()), offset[r].crossings + w.along_b.size()};
      if (offset[r + 1].crossings > most) throw too_many_crossings(most);
      out_.max_move = std::max(out_.max_move, w.max_move);
    }
    const Offset total = offset[ranges];
    out_.first_corner = total.vertices;
    out_.lines[0].first.resize(edges + 1);
    out_.lines[0].first[edges] = total.nodes;
    out_.lines[0].nodes.resize(total.nodes);
    out_.under.resize(total.nodes);
    out_.vertex_of_node.resize(total.nodes);
    along_b_.resize(total.crossings);
    out_.node_of_crossing.resize(total.vertices - out_.first_crossing);
    out_.points.resize(total.vertices + 4);
    for (auto& z : out_.heights) z.resize(total.vertices + 4);
    parallel_tasks(context_, ranges, [&](std::size_t r) {
      const Walked w = std::move(walked[r]);
      const Offset at = offset[r];
      const Index vertices = static_cast<Index>(w.node_of_crossing.size());
      for (std::size_t i = 0; i < w.first.size(); ++i) out_.lines[0].first[at.edges + i] = w.first[i] + at.nodes;
      std::copy(w.nodes.begin(), w.nodes.end(), out_.lines[0].nodes.begin() + at.nodes);
      std::copy(w.under.begin(), w.under.end(), out_.under.begin() + at.nodes);
      for (std::size_t i = 0; i < w.nodes.size(); ++i) {
        const Index v = w.vertex_of_node[i];  // arbitrary where no crossing stands
        out_.vertex_of_node[at.nodes + i] = v == none ? none : v + at.vertices;
      }
      std::copy(w.along_b.begin(), w.along_b.end(), along_b_.begin() + at.crossings);
      for (Index i = 0; i < vertices; ++i)
        out_.node_of_crossing[at.vertices - out_.first_crossing + i] = w.node_of_crossing[i] + at.nodes;
      std::copy_n(w.points.begin(), vertices, out_.points.begin() + at.vertices);
      for (int m = 0; m < 2; ++m) std::copy_n(w.heights[m].begin(), vertices, out_.heights[m].begin() + at.vertices);
      for (const auto& [place, node] : w.touched) place_in_lines_[1][place] = node + at.nodes;
      for (const Index e : w.covered) std::atomic_ref(out_.covered[e]).store(1, std::memory_order_relaxed);
    });
  }

  /// The one range that there is.
  void take(Walked walked) {
    out_.first_corner = out_.first_crossing + static_cast<Index>(walked.node_of_crossing.size());
    out_.max_move = walked.max_move;
    out_.lines[0] = {std::move(walked.first), std::move(walked.nodes)};
    out_.lines[0].first.push_back(static_cast<Index>(out_.lines[0].nodes.size()));
    out_.under = std::move(walked.under);
    out_.vertex_of_node = std::move(walked.vertex_of_node);
    along_b_ = std::move(walked.along_b);
    out_.node_of_crossing = std::move(walked.node_of_crossing);
    out_.points = std::move(walked.points);
    for (int m = 0; m < 2; ++m) out_.heights[m] = std::move(walked.heights[m]);
    for (const auto& [place, node] : walked.touched) place_in_lines_[1][place] = node;
    for (const Index e : walked.covered) out_.covered[e] = 1;
  }

  /// Sorts what lies on each edge of B along it: by a double parameter, exactly where that cannot tell.
  void fill_lines_of_b() {
    const CompletedMesh& b = mesh(1);
    const Index edges = b.edges();
    Array<Index>& first = out_.lines[1].first;
    Array<Index> filled(edges, 0);
    for (const Node node : out_.lines[0].nodes)
      if (node.crossing()) ++filled[node.index()];
    for (Index i = 0; i < places(0); ++i)
      if (out_.location[0][i].kind == Location::edge) ++filled[b.edge_of(out_.location[0][i].index)];
    first.resize(edges + 1);
    first[0] = 0;
    for (Index e = 0; e < edges; ++e) {
      first[e + 1] = first[e] + filled[e] + 2;
      filled[e] = first[e] + 1;
    }
    Array<Node>& nodes = out_.lines[1].nodes;
    nodes.resize(first[edges]);
    keys_.resize(first[edges] - 2 * static_cast<std::size_t>(edges));
    const double* along = along_b_.data();
    for (std::size_t i = 0; i < out_.lines[0].nodes.size(); ++i) {
      const Node node = out_.lines[0].nodes[i];
      if (!node.crossing()) continue;
      const Index at = filled[node.index()]++;
      nodes[at] = Node(node.kind(), static_cast<Index>(i));
      key(node.index(), at) = *along++;
    }
    along_b_ = {};
    for (Index i = 0; i < places(0); ++i)
      if (out_.location[0][i].kind == Location::edge) {
        const Index h = out_.location[0][i].index, at = filled[b.edge_of(h)]++;
        const Point2 o = b.at(b.origin(h)), t = b.at(b.target(h)), p = mesh(0).at(i);
        nodes[at] = Node(Node::junction, i);  // by its place for now
        key(b.edge_of(h), at) = by_x(o, t) ? (p.x - o.x) / (t.x - o.x) : (p.y - o.y) / (t.y - o.y);
      }
    parallel_for(context_, edges, chunk_for(context_, edges), [&](std::size_t begin, std::size_t end) {
      for (std::size_t e = begin; e < end; ++e) sort_line(static_cast<Index>(e));
    });
    keys_ = {};
  }

  /// How far along edge e of B the node `at` of its line lies, about; ends have none.
  double& key(Index e, Index at) { return keys_[static_cast<std::size_t>(at) - 2 * static_cast<std::size_t>(e) - 1]; }

  static bool by_x(Point2 o, Point2 t) { return std::fabs(t.x - o.x) >= std::fabs(t.y - o.y); }

  Node end_node(int m, Index h, Index place) const {
    const Index junction = out_.junction_of[m][place];
    return junction != none ? Node(Node::junction, junction) : Node(Node::end, h);
  }

  void sort_line(Index e) {
    const CompletedMesh& b = mesh(1);
    Array<Node>& nodes = out_.lines[1].nodes;
    const Index begin = out_.lines[1].first[e] + 1, end = out_.lines[1].first[e + 1] - 1;
    const Index h = b.half[e];
    nodes[begin - 1] = end_node(1, b.twin(h), b.origin(h));
    nodes[end] = end_node(1, h, b.target(h));
    if (begin == end) return;
    for (Index i = begin + 1; i < end; ++i) {  // insertion: a handful each, mostly in order
      const Node node = nodes[i];
      const double own = key(e, i);
      Index j = i;
      for (; j > begin; --j) {
        const double before = key(e, j - 1);
        const bool less = std::fabs(own - before) > 4e-12 * std::max(own, before)
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
  Array<double> along_b_;  // of crossings in the order of A's lines
  Array<double> keys_;
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
