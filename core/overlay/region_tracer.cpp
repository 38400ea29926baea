// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay/region_tracer.hpp"

#include <algorithm>

#include "core/error.hpp"

namespace terrane {

void RegionTracer::face_of_a(Index f) {
  if (paste_ && a_.real(f)) return whole(0, f, {f, none});
  const Lines& lines = arrangement_.lines[0];
  Index under = none;
  bool plain = true;
  for (int k = 0; k < 3 && plain; ++k) {
    const Index h = 4 * f + k, at = lines.first[a_.edge_of(h)];
    const Index face = arrangement_.face_of_b(at, a_.against(h));
    plain = lines.pieces(a_.edge_of(h)) == 1 && (k == 0 || face == under);
    under = face;
  }
  if (plain && a_.real(f)) return emit_convex(f, parent_in_b(under), corners_of(a_, 0, f), {});
  if (plain) {
    for (int k = 0; k < 3; ++k) group(f, under, arrangement_.leaving(0, 4 * f + k));
    return;
  }
  for (int k = 0; k < 3; ++k) {
    const Index h = 4 * f + k, e = a_.edge_of(h), direction = a_.against(h);
    const Index first = lines.first[e], count = lines.pieces(e);
    for (Index i = 0; i < count; ++i) {
      const LinePiece start{0, direction == 0 ? first + i : first + count - 1 - i, direction};
      if (!visited_[2 * static_cast<std::size_t>(start.at) + start.direction]) trace(f, start);
    }
  }
}

void RegionTracer::face_of_b(Index g) {
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
  if (in_b != none && !outline_) return emit_convex(in_a, in_b, corners_of(b_, 1, g), {});
  for (int k = 0; k < 3; ++k) group(f, g, arrangement_.leaving(1, 4 * g + k));
}

void RegionTracer::whole(int m, Index f, std::array<Index, 2> parents) {
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
  emit_convex(parents[0], parents[1], whole_corners_, whole_straight_);
}

std::array<Index, 3> RegionTracer::corners_of(const CompletedMesh& mesh, int m, Index f) const {
  const Array<Index>& number = arrangement_.number[m];
  return {number[mesh.corner(4 * f)], number[mesh.corner(4 * f + 1)], number[mesh.corner(4 * f + 2)]};
}

void RegionTracer::trace(Index f, const LinePiece& start) {
  const Index g = arrangement_.face_of_b(start.at, start.direction);
  if (a_.real(f) && b_.real(g) && !outline_) return trace_in_both(f, g, start);
  LinePiece piece = start;
  do {
    visit(piece);
    group(f, g, piece);
    bool straight;
    piece = arrangement_.next(piece, straight);
  } while (piece != start);
}

void RegionTracer::trace_in_both(Index f, Index g, const LinePiece& start) {
  const Index* const vertex_of_node = arrangement_.vertex_of_node.data();
  const Index start_at = start.at, start_direction = start.direction;
  std::uint8_t* const visited = visited_.data();
  Index* corners = corners_.data();
  std::size_t count = 0, room = corners_.size();
  bool bends = true;  // everywhere
  Index m = 0, at = start_at, direction = start_direction;
  do {
    // A piece of B marks the place of the region's first piece, which is marked anyway.
    const Index mark = m == 0 ? at : start_at, marked = m == 0 ? direction : start_direction;
    visited[2 * static_cast<std::size_t>(mark) + marked] = 1;
    if (count == room) {
      room = 2 * count + 16;
      corners_.resize(room);
      straight_.resize(room, 0);
      corners = corners_.data();
    }
    const Side& side = side_[m];
    const Index head = at + 1 - direction;
    const Node node = side.nodes[head];
    const Index index = node.index();
    if (node.crossing()) {
      corners[count] = vertex_of_node[m == 0 ? head : index];
      direction = direction ^ static_cast<Index>(node.kind()) ^ m;
      at = index - direction;
      m = 1 - m;
    } else if (node.kind() == Node::end) {
      const Index h = next_half(index);
      const LinkedFace& face = side.faces[h >> 2];
      corners[count] = side.number[face.corner[h & 3]];
      const Index edge = face.edge[h & 3];
      direction = edge & 1;
      at = side.first[(edge >> 1) + direction] - 2 * direction;
    } else {
      bool straight = false;
      corners[count] = arrangement_.vertex(m, head);
      const LinePiece piece = arrangement_.next({m, at, direction}, straight);
      m = piece.mesh, at = piece.at, direction = piece.direction;
      if (straight) straight_[count] = 1, bends = false;
    }
    ++count;
  } while ((m | (at ^ start_at) | (direction ^ start_direction)) != 0);
  emit_convex(f, g, {corners, count}, {straight_.data(), bends ? 0 : count});
  if (!bends) std::fill_n(straight_.begin(), count, 0);  // all 0 between regions
}

void RegionTracer::visit(const LinePiece& piece) {
  if (piece.mesh == 0) visited_[2 * static_cast<std::size_t>(piece.at) + piece.direction] = 1;
}

void RegionTracer::emit_convex(Index a, Index b, std::span<const Index> corners,
                               std::span<const std::uint8_t> straight) {
  ++sink_.regions;
  sink_.make_room(corners.size() - 2);
  const bool positive = triangulator_.run(corners, straight, points_, [&](Index u, Index v, Index w) {
    sink_.add({u, v, w}, {a, b});
  });
  sink_.all_positive = sink_.all_positive && positive;
}

Index RegionTracer::edge_of(int m, Index f, const LinePiece& piece) const {
  const Lines& lines = arrangement_.lines[m];
  for (int k = 0; k < 3; ++k) {
    const Index e = arrangement_.mesh[m]->edge_of(4 * f + k);
    if (lines.first[e] <= piece.at && piece.at < lines.first[e + 1]) return e;
  }
  throw Error(ErrorKind::internal, "overlay", "a region has a border that its faces do not have");
}

void RegionTracer::group(Index f, Index g, const LinePiece& piece) {
  const auto border_of_b = [&](Index e) { return outline_ ? b_.sides[e] == 1 : b_.sides[e] > 0; };
  const Index e = edge_of(piece.mesh, piece.mesh == 0 ? f : g, piece);
  bool significant = piece.mesh == 0 ? a_.sides[e] > 0 : border_of_b(e);
  if (!significant && piece.mesh == 0 && arrangement_.under[piece.at] < 0)
    significant = border_of_b(b_.edge_of(~arrangement_.under[piece.at]));
  if (significant) sink_.grouped.push_back({groups_.of(a_.real(f) ? f : none, b_.real(g) ? g : none), piece});
}

}  // namespace terrane
