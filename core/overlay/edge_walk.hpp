// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/error.hpp"
#include "core/overlay/arrangement.hpp"

namespace terrane {

/// What following a range of A's edges through B found. Numbers of nodes, crossings and vertices count from the
/// beginning of the range.
struct Walked {
  Array<Index> first;     // per edge of the range: its origin in nodes
  Array<Node> nodes;      // of a crossing, for now, the one found before it on the same edge of B: see last_on_b
  Array<Node> last_on_b;  // per edge of B: the crossing found last, as its own line will have it; an `end` for none
  Array<Index> under;     // see Arrangement, as the next one
  Array<Index> vertex_of_node;
  Array<float> along_b;  // per node that is a crossing: how far along B's edge, 0 to 1; relative error below 1e-7
  Index vertices = 0;    // so many crossings have one; theirs is what follows
  Array<Point2> points;
  Array<double> heights[2];
  std::vector<std::array<Index, 2>> touched;  // places of B inside edges of A, each with its node
  std::vector<Index> covered;                 // edges of B along which a piece lies
};

/// How much the ranges before one found.
struct WalkedOffset {
  Index edges = 0, nodes = 0, vertices = 0;
  std::size_t crossings = 0;  // and places of B inside edges of A
  WalkedOffset after(const Walked& walked) const;
};

/// Makes room for all that was found.
void extend(Walked& all, const WalkedOffset& total, Index first_vertex);
/// Copies one of the parts, about equal in bytes, of what a later range found to its place there; the numbers it keeps
/// in `more` itself follow.
inline constexpr int walked_parts = 4;
void append(Walked& all, const WalkedOffset& at, Walked& more, Index first_vertex, int part);

struct WalkRange {
  Index begin, end;
  Index first_vertex;   // numbers of vertices begin here
  Index edges_to_come;  // how many to make room for
};

/// Follows a range of A's edges through B from face to face, deciding every step by the side on which a vertex of B
/// lies: Guibas & Seidel (1987), Jiao & Heath (2004). Reads of `arrangement` the meshes, the locations, the junctions
/// of places and which places have a vertex. Throws Error{limit, "too-many-crossings"} above `most`.
Walked walk_edges(const Arrangement& arrangement, Refinement refinement, const WalkRange& range, std::size_t most,
                  const Context& context);

Error too_many_crossings(std::size_t most);

}  // namespace terrane
