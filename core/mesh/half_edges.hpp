// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/mesh/array.hpp"
#include "core/tin.hpp"

namespace terrane {

/// A half-edge is 3 * face + corner and runs from that corner to the next one, the face on its left.
inline Index next_in_face(Index h) { return h % 3 == 2 ? h - 2 : h + 1; }
inline Index previous_in_face(Index h) { return h % 3 == 0 ? h + 2 : h - 1; }

/// The faces of a valid TIN that have an area in plan, connected where they share both vertices of an edge: the two
/// sides of a jump are not. Faces keep the order of the TIN; walls are left out.
struct HalfEdges {
  Array<Face> faces;
  Array<Index> mate;  // per half-edge: the other one of its edge, or none at a border and at a jump
  /// Per vertex: a half-edge that leaves it, or none. Of a vertex on a border one without a mate, so that going round
  /// counter-clockwise from it passes every face of a fan.
  Array<Index> out;
  /// Half-edges without a mate at vertices that several of them leave (fans that touch in a point), sorted by vertex.
  std::vector<Index> other_fans;

  Index from(Index h) const { return faces[h / 3][h % 3]; }
  Index to(Index h) const { return from(next_in_face(h)); }
  /// The half-edge that follows h counter-clockwise around the vertex both leave, or none.
  Index turn_left(Index h) const { return mate[previous_in_face(h)]; }
  /// Does the border pass v?
  bool at_border(Index v) const { return out[v] != none && mate[out[v]] == none; }
};

/// `across_jumps`: the two sides of a jump are mates, too; its half-edges run between vertices at the same two places.
/// O(n log n); see plan_topology.
HalfEdges half_edges(const Tin& tin, const Context& context, bool across_jumps = false);

}  // namespace terrane
