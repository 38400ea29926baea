// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay_faces.hpp"

#include <algorithm>
#include <iterator>
#include <span>

#include "core/convex.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/region_fill.hpp"

namespace terrane {
namespace {

/// A piece of the border of a region that ghost edges cut up.
struct GroupedPiece {
  Index group;
  Piece piece;
};

/// What one range of faces gave.
struct Sink {
  Array<Face> faces;
  Array<std::array<Index, 2>> parents;
  std::vector<GroupedPiece> grouped;
  Index regions = 0;
  bool all_positive = true;
};

/// Groups: a face of A without B is its number, a face of B without A comes after those, then the exterior.
struct Groups {
  Index faces_of_a, exterior;
  explicit Groups(const Arrangement& arrangement)
      : faces_of_a(arrangement.mesh[0]->faces()), exterior(faces_of_a + arrangement.mesh[1]->faces()) {}
  Index of(Index a, Index b) const { return a != none ? a : b != none ? faces_of_a + b : exterior; }
  std::array<Index, 2> parents(Index group) const {
    if (group < faces_of_a) return {group, none};
    return {none, group < exterior ? group - faces_of_a : none};
  }
};

/// Traces the regions of a range of faces and triangulates those that are convex.
class RegionTracer {
 public:
  RegionTracer(const Arrangement& arrangement, Refinement refinement, std::span<std::uint8_t> visited, Sink& sink)
      : arrangement_(arrangement),
        a_(*arrangement.mesh[0]),
        b_(*arrangement.mesh[1]),
        groups_(arrangement),
        paste_(refinement == Refinement::paste),
        visited_(visited),
        points_(arrangement.points.data()),
        sink_(sink) {}

  /// All regions in a face of A that touch its border.
  void face_of_a(Index f) {
    if (paste_ && a_.real(f)) return whole(0, f);
    const Lines& lines = arrangement_.lines[0];
    Index under = none;
    bool plain = true;
    for (int k = 0; k < 3 && plain; ++k) {
      const Index h = 4 * f + k, at = lines.first[a_.edge_of(h)];
      const Index face = arrangement_.face_of_b(at, a_.against(h));
      plain = lines.pieces(a_.edge_of(h)) == 1 && (k == 0 || face == under);
      under = face;
    }
    if (plain && a_.real(f)) return emit_convex(f, b_.real(under) ? under : none, corners_of(a_, 0, f), {});
    if (plain) {
      for (int k = 0; k < 3; ++k) group(f, under, arrangement_.leaving(0, 4 * f + k));
      return;
    }
    for (int k = 0; k < 3; ++k) {
      const Index h = 4 * f + k, e = a_.edge_of(h), direction = a_.against(h);
      const Index first = lines.first[e], count = lines.pieces(e);
      for (Index i = 0; i < count; ++i) {
        const Piece start{0, direction == 0 ? first + i : first + count - 1 - i, direction};
        if (!visited_[2 * static_cast<std::size_t>(start.at) + start.direction]) trace(f, start);
      }
    }
  }

  /// A face of B that no piece of A touches or enters lies in one face of A.
  void face_of_b(Index g) {
    for (int k = 0; k < 3; ++k) {
      const Index e = b_.edge_of(4 * g + k);
      if (arrangement_.lines[1].pieces(e) != 1 || arrangement_.covered[e]) return;
    }
    Index f = none;
    for (int k = 0; k < 3; ++k) {
      f = arrangement_.face_of_a_after(4 * g + k);
      if (f == none) return;
    }
    if (paste_ && a_.real(f)) return;
    const Index in_a = a_.real(f) ? f : none, in_b = b_.real(g) ? g : none;
    if (in_b != none) return emit_convex(in_a, in_b, corners_of(b_, 1, g), {});
    for (int k = 0; k < 3; ++k) group(f, g, arrangement_.leaving(1, 4 * g + k));
  }

  /// A whole face of m, with the vertices of the other mesh that stay on its edges.
  void whole(int m, Index f) {
    const CompletedMesh& mesh = *arrangement_.mesh[m];
    const Lines& lines = arrangement_.lines[m];
    whole_corners_.clear();
    whole_straight_.clear();
    for (int k = 0; k < 3; ++k) {
      const Index h = 4 * f + k, e = mesh.edge_of(h), inside = lines.pieces(e) - 1;
      whole_corners_.push_back(arrangement_.number[m][mesh.origin(h)]);
      whole_straight_.push_back(false);
      for (Index i = 0; i < inside; ++i) {
        const Index at = mesh.against(h) ? lines.first[e + 1] - 2 - i : lines.first[e] + 1 + i;
        const Index v = arrangement_.vertex(m, at);
        if (v == none) continue;
        whole_corners_.push_back(v);
        whole_straight_.push_back(true);
      }
    }
    emit_convex(m == 0 ? f : none, m == 1 ? f : none, whole_corners_, whole_straight_);
  }

 private:
  std::array<Index, 3> corners_of(const CompletedMesh& mesh, int m, Index f) const {
    const Array<Index>& number = arrangement_.number[m];
    return {number[mesh.corner(4 * f)], number[mesh.corner(4 * f + 1)], number[mesh.corner(4 * f + 2)]};
  }

  /// Follows the border of the region to the left of a piece of face f of A.
  void trace(Index f, const Piece& start) {
    const Index g = arrangement_.face_of_b(start.at, start.direction);
    if (a_.real(f) && b_.real(g)) return trace_in_both(f, g, start);
    Piece piece = start;
    do {
      visit(piece);
      group(f, g, piece);
      bool straight;
      piece = arrangement_.next(piece, straight);
    } while (piece != start);
  }

  /// The same where there is nothing to it but corners: the innermost loop of the overlay, so the piece it stands on is
  /// three local numbers and all arrays are local pointers. It walks to and fro between pieces of A and of B.
  void trace_in_both(Index f, Index g, const Piece& start) {
    const Node *const nodes_a = arrangement_.lines[0].nodes.data(), *const nodes_b = arrangement_.lines[1].nodes.data();
    const Index *const first_a = arrangement_.lines[0].first.data(), *const first_b =
                                                                         arrangement_.lines[1].first.data();
    const Index *const number_a = arrangement_.number[0].data(), *const number_b = arrangement_.number[1].data();
    const LinkedFace *const faces_a = a_.links.data(), *const faces_b = b_.links.data();
    const Index* const vertex_of_node = arrangement_.vertex_of_node.data();
    std::uint8_t* const visited = visited_.data();
    Index* corners = corners_.data();
    std::size_t count = 0, room = corners_.size();
    bool bends = true;  // everywhere
    bool on_a = true;
    Index at = start.at, direction = start.direction;
    do {
      if (on_a) visited[2 * static_cast<std::size_t>(at) + direction] = 1;
      if (count == room) {
        room = 2 * count + 16;
        corners_.resize(room);
        straight_.resize(room, 0);
        corners = corners_.data();
      }
      const Index head = at + 1 - direction;
      const Node node = (on_a ? nodes_a : nodes_b)[head];
      const Index index = node.index();
      if (node.crossing()) {
        corners[count] = vertex_of_node[on_a ? head : index];
        direction = direction ^ static_cast<Index>(node.kind()) ^ static_cast<Index>(!on_a);
        at = index - direction;
        on_a = !on_a;
      } else if (node.kind() == Node::end) {
        const Index h = next_half(index);
        const LinkedFace& face = (on_a ? faces_a : faces_b)[h >> 2];
        corners[count] = (on_a ? number_a : number_b)[face.corner[h & 3]];
        const Index edge = face.edge[h & 3];
        direction = edge & 1;
        at = (on_a ? first_a : first_b)[(edge >> 1) + direction] - 2 * direction;
      } else {
        const int m = on_a ? 0 : 1;
        bool straight = false;
        corners[count] = arrangement_.vertex(m, head);
        const Piece piece = arrangement_.next({m, at, direction}, straight);
        on_a = piece.mesh == 0, at = piece.at, direction = piece.direction;
        if (straight) straight_[count] = 1, bends = false;
      }
      ++count;
    } while (!(on_a && at == start.at && direction == start.direction));
    emit_convex(f, g, {corners, count}, {straight_.data(), bends ? 0 : count});
    if (!bends) std::fill_n(straight_.begin(), count, 0);  // all 0 between regions
  }

  void visit(const Piece& piece) {
    if (piece.mesh == 0) visited_[2 * static_cast<std::size_t>(piece.at) + piece.direction] = 1;
  }

  void emit_convex(Index a, Index b, std::span<const Index> corners, std::span<const std::uint8_t> straight) {
    ++sink_.regions;
    const std::size_t first = sink_.faces.size(), count = corners.size() - 2;
    sink_.faces.resize(first + count);
    sink_.parents.resize(first + count);
    std::array<Index, 2>* parents = sink_.parents.data() + first;
    Face* face = sink_.faces.data() + first;
    const bool positive = triangulator_.run(corners, straight, points_, [&](Index u, Index v, Index w) {
      (*face)[0] = u, (*face)[1] = v, (*face)[2] = w;
      (*parents)[0] = a, (*parents)[1] = b;
      ++face, ++parents;
    });
    sink_.all_positive = sink_.all_positive && positive;
  }

  /// The edge of face f of mesh m that a piece is part of.
  Index edge_of(int m, Index f, const Piece& piece) const {
    const Lines& lines = arrangement_.lines[m];
    for (int k = 0; k < 3; ++k) {
      const Index e = arrangement_.mesh[m]->edge_of(4 * f + k);
      if (lines.first[e] <= piece.at && piece.at < lines.first[e + 1]) return e;
    }
    throw Error(ErrorKind::internal, "overlay", "a region has a border that its faces do not have");
  }

  /// Notes a piece of the border of a region outside A or B, unless it is a ghost edge's.
  void group(Index f, Index g, const Piece& piece) {
    bool significant = arrangement_.mesh[piece.mesh]->sides[edge_of(piece.mesh, piece.mesh == 0 ? f : g, piece)] > 0;
    if (!significant && piece.mesh == 0 && arrangement_.under[piece.at] < 0)
      significant = b_.sides[b_.edge_of(~arrangement_.under[piece.at])] > 0;
    if (significant) sink_.grouped.push_back({groups_.of(a_.real(f) ? f : none, b_.real(g) ? g : none), piece});
  }

  const Arrangement& arrangement_;
  const CompletedMesh &a_, &b_;
  Groups groups_;
  bool paste_;
  std::span<std::uint8_t> visited_;
  const Point2* points_;
  Sink& sink_;
  std::vector<Index> corners_, whole_corners_;  // buffers
  std::vector<std::uint8_t> straight_, whole_straight_;
  ConvexTriangulator triangulator_;
};

/// Puts together and triangulates what ghost edges cut up.
class GroupFiller {
 public:
  GroupFiller(const Arrangement& arrangement, Refinement refinement, bool exactly, Sink& sink)
      : arrangement_(arrangement),
        groups_(arrangement),
        exactly_(exactly),
        sink_(sink),
        tracer_(arrangement, refinement, {}, sink) {}

  /// Pieces sorted by group. Sets `exterior` to where its faces begin.
  void run(std::span<const GroupedPiece> grouped, std::size_t& exterior) {
    exterior = sink_.faces.size();
    for (std::size_t i = 0; i < grouped.size();) {
      std::size_t j = i;
      const Index group = grouped[i].group;
      bool only[2] = {true, true};
      for (; j < grouped.size() && grouped[j].group == group; ++j) only[1 - grouped[j].piece.mesh] = false;
      const auto [a, b] = groups_.parents(group);
      if (group == groups_.exterior) exterior = sink_.faces.size();
      if (a != none && only[0])
        tracer_.whole(0, a);
      else if (b != none && only[1])
        tracer_.whole(1, b);
      else
        fill(group, grouped.subspan(i, j - i));
      i = j;
    }
  }

 private:
  /// A region with any border: pieces are joined over vertices that do not stay, then filled.
  void fill(Index group, std::span<const GroupedPiece> pieces) {
    border_.clear();
    for (const GroupedPiece& g : pieces) {
      Piece p = g.piece;
      const Index from = arrangement_.vertex(p.mesh, p.tail());
      if (from == none) continue;
      Index to;
      while ((to = arrangement_.vertex(p.mesh, p.head())) == none) p.at += p.direction == 0 ? 1 : -1;
      border_.push_back({from, to});
    }
    FilledRegion filled;
    if (!exactly_) filled = fill_region(arrangement_.points, border_);
    if (!filled.sound)
      filled = fill_region_exactly(
          arrangement_.points, [&](Index v) { return exact_place(arrangement_, v); }, border_);
    if (!filled.sound) throw Error(ErrorKind::internal, "overlay", "a region's border does not close");
    if (group != groups_.exterior) sink_.regions += filled.parts;
    const auto& at = arrangement_.points;
    for (const Face& f : filled.faces) {
      sink_.faces.push_back(f);
      sink_.parents.push_back(groups_.parents(group));
      sink_.all_positive = sink_.all_positive && orientation(at[f[0]], at[f[1]], at[f[2]]) > 0;
    }
  }

  const Arrangement& arrangement_;
  Groups groups_;
  bool exactly_;
  Sink& sink_;
  RegionTracer tracer_;
  std::vector<BorderEdge> border_;
};

/// Every face of A, then every face of B, in ranges.
Sink trace_all(const Arrangement& arrangement, Refinement refinement, Context& context) {
  const std::size_t count[2] = {static_cast<std::size_t>(arrangement.mesh[0]->faces()),
                                static_cast<std::size_t>(arrangement.mesh[1]->faces())};
  const std::size_t chunk[2] = {chunk_for(context, count[0]), chunk_for(context, count[1])};
  const std::size_t ranges[2] = {(count[0] - 1) / chunk[0] + 1, (count[1] - 1) / chunk[1] + 1};
  const bool alone = ranges[0] + ranges[1] == 2;  // then both ranges, one after the other, share a sink
  Array<std::uint8_t> visited(2 * arrangement.lines[0].nodes.size(), 0);
  std::vector<Sink> sinks(alone ? 1 : ranges[0] + ranges[1]);
  // What general position gives; memory that is never touched costs nothing.
  const std::size_t expected = 2 * static_cast<std::size_t>(arrangement.first_corner) + 64;
  for (int m = 0; m < 2; ++m)
    parallel_for(context, count[m], chunk[m], [&](std::size_t begin, std::size_t end) {
      Sink& place = sinks[alone ? 0 : m * ranges[0] + begin / chunk[m]];
      Sink sink = std::move(place);  // on this thread's own cache lines while it grows
      if (m == 0) {
        const std::size_t share = begin == 0 ? expected : expected / ranges[0];
        sink.faces.reserve(share);
        sink.parents.reserve(share);
      }
      RegionTracer tracer(arrangement, refinement, visited, sink);
      for (std::size_t f = begin; f < end; ++f) {
        if ((f & 0xFFFF) == 0) context.stop_if_cancelled();
        if (m == 0)
          tracer.face_of_a(static_cast<Index>(f));
        else
          tracer.face_of_b(static_cast<Index>(f));
      }
      place = std::move(sink);
    });
  Sink& all = sinks[0];
  std::vector<std::size_t> offset{0};
  for (const Sink& sink : sinks) {
    offset.push_back(offset.back() + sink.faces.size());
    if (&sink == &all) continue;
    all.grouped.insert(all.grouped.end(), sink.grouped.begin(), sink.grouped.end());
    all.regions += sink.regions;
    all.all_positive = all.all_positive && sink.all_positive;
  }
  all.faces.resize(offset.back());
  all.parents.resize(offset.back());
  parallel_tasks(context, sinks.size() - 1, [&](std::size_t i) {
    const Sink& sink = sinks[i + 1];
    std::copy(sink.faces.begin(), sink.faces.end(), all.faces.begin() + static_cast<std::ptrdiff_t>(offset[i + 1]));
    std::copy(sink.parents.begin(), sink.parents.end(),
              all.parents.begin() + static_cast<std::ptrdiff_t>(offset[i + 1]));
  });
  return std::move(all);
}

}  // namespace

OverlayFaces faces_of(const Arrangement& arrangement, Refinement refinement, Context& context) {
  Sink sink = trace_all(arrangement, refinement, context);
  context.progress("overlay", 0.75);
  std::stable_sort(sink.grouped.begin(), sink.grouped.end(), [](auto& s, auto& t) { return s.group < t.group; });
  const std::vector<GroupedPiece> grouped = std::move(sink.grouped);
  const std::size_t plain = sink.faces.size();
  const Index plain_regions = sink.regions;
  std::size_t exterior;
  GroupFiller(arrangement, refinement, false, sink).run(grouped, exterior);
  if (!sink.all_positive) {
    sink.faces.resize(plain);
    sink.parents.resize(plain);
    sink.regions = plain_regions;
    GroupFiller(arrangement, refinement, true, sink).run(grouped, exterior);
  }
  context.progress("overlay", 0.8);
  return {std::move(sink.faces), std::move(sink.parents), exterior, sink.regions, sink.all_positive};
}

}  // namespace terrane
