// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <unordered_map>

#include "core/context.hpp"
#include "core/mesh/array.hpp"
#include "core/overlay.hpp"
#include "core/overlay/completed.hpp"
#include "core/rounding/rounding.hpp"

// The exact combinatorial overlay of two completed meshes: who crosses whom, in which order, and how one gets on from
// there. Nothing here looks at a constructed coordinate; crossings are rounded where they are found only because
// everything needed for it is at hand there.
//
// Notation. Mesh 0 is A, mesh 1 is B. A vertex is a vertex of the result: the kept places of A, the kept places of B
// that are on none of A, the kept crossings, the four corners of the box; places and crossings that leave no trace in
// the result have no vertex. The line of an edge is its origin, what lies strictly inside it, and its target, in order
// along its defining half-edge; a piece runs from one node of a line to the next.
namespace terrane {

/// What stands at one place of a line.
class Node {
 public:
  enum Kind : std::uint32_t {
    leftward = 0,   // a crossing at which B's defining half-edge passes from A's right to its left
    rightward = 1,  // or the other way; index: where the crossing stands in the lines of the other mesh
    end = 2,        // index: the half-edge by which one comes here
    junction = 3    // index: its number
  };
  Node() = default;
  Node(Kind kind, Index index) : bits_(static_cast<std::uint32_t>(kind) << 30 | static_cast<std::uint32_t>(index)) {}
  Kind kind() const { return static_cast<Kind>(bits_ >> 30); }
  bool crossing() const { return bits_ >> 31 == 0; }
  Index index() const { return static_cast<Index>(bits_ & 0x3FFFFFFF); }

 private:
  std::uint32_t bits_;
};

/// The lines of all edges of one mesh, one after the other.
struct Lines {
  Array<Index> first;  // of edge e: nodes first[e] .. first[e + 1] - 1
  Array<Node> nodes;
  Index pieces(Index e) const { return first[e + 1] - first[e] - 1; }
};

/// A directed piece: from nodes[at] to nodes[at + 1] in direction 0, back in direction 1.
struct LinePiece {
  int mesh;
  Index at, direction;
  Index tail() const { return at + direction; }
  Index head() const { return at + 1 - direction; }
  bool operator==(const LinePiece&) const = default;
};

/// A place of one mesh on a place or an edge of the other: the pieces that leave it, counter-clockwise.
struct Spoke {
  std::uint32_t
      key[2];       // of the piece of A and of B in this direction; no_key where there is none. A's speaks for both
  Index face_of_a;  // of the sector that follows counter-clockwise
  bool straight;    // the spoke before this one leads on in the opposite direction of this one
};

struct Arrangement {
  const CompletedMesh* mesh[2];
  Array<Location> location[2];  // of a place of m in the other mesh
  Array<Index> number[2];       // of a place of m: its vertex, or none
  Lines lines[2];
  static constexpr Index not_followed = std::numeric_limits<Index>::max();
  /// Per piece of A: the face of B that it lies in; ~h when it lies along half-edge h of B, in direction 0; or
  /// not_followed.
  Array<Index> under;
  Array<Index> vertex_of_node;  // per node of A: the vertex of a crossing; where it has none, ~ the next one that has
  Array<std::uint8_t> covered;  // per edge of B: some piece of A lies along it

  Array<Index> junction_of[2];  // of a place of m
  Array<Index> first_spoke;  // of junction j: spokes first_spoke[j] .. first_spoke[j + 1] - 1; none where all is shared
  Array<Index> vertex_of_junction;
  Array<Spoke> spokes;
  std::unordered_map<std::uint32_t, Index> crowded;  // of junctions with many spokes: which one has a key

  Index first_b = 0, first_crossing = 0, first_corner = 0;  // vertices from here on are B's own places, crossings, ...
  Array<Index> place_of_vertex;                             // below first_crossing: a place of A; from first_b on, of B
  Array<Point2> points;                                     // of every vertex; crossings rounded
  Array<double> heights[2];  // of crossings and places, where the mesh has no jumps; NaN outside
  double max_move = 0;       // an upper bound of the rounding of crossings

  static constexpr std::uint32_t no_key = 0xFFFFFFFF;
  std::uint32_t key(const LinePiece& p) const {
    return (p.mesh == 0 ? 0 : 2 * static_cast<std::uint32_t>(lines[0].nodes.size())) +
           2 * static_cast<std::uint32_t>(p.at) + static_cast<std::uint32_t>(p.direction);
  }
  LinePiece piece(std::uint32_t key) const {
    const std::uint32_t of_a = 2 * static_cast<std::uint32_t>(lines[0].nodes.size());
    const int m = key >= of_a;
    if (m) key -= of_a;
    return {m, static_cast<Index>(key >> 1), static_cast<Index>(key & 1)};
  }
  /// The vertex at a node of the lines of m, or none.
  Index vertex(int m, Index at) const {
    const Node node = lines[m].nodes[at];
    if (node.crossing()) return std::max(vertex_of_node[m == 0 ? at : node.index()], none);
    return node.kind() == Node::end ? number[m][mesh[m]->target(node.index())] : vertex_of_junction[node.index()];
  }
  /// Where a crossing that has a vertex stands in the lines of A, and the edge of m that passes there.
  Index node_of(Index vertex) const;
  Index edge_through(int m, Index node_of_a) const;
  /// The face of B to the left of a piece of A.
  Index face_of_b(Index at, Index direction) const {
    const Index under_it = under[at];
    if (under_it >= 0) return under_it;
    const Index h = direction == 0 ? ~under_it : mesh[1]->twin(~under_it);
    return h == none ? none : h >> 2;
  }
  /// The first piece along half-edge h.
  LinePiece leaving(int m, Index h) const {
    const Index e = mesh[m]->edge_of(h);
    return mesh[m]->against(h) ? LinePiece{m, lines[m].first[e + 1] - 2, 1} : LinePiece{m, lines[m].first[e], 0};
  }
  /// The same three edges, whole, in both meshes.
  bool shared(Index face_of_a) const;
  /// Where the region to the left of a piece goes on at its head. `straight`: without a bend, which happens at
  /// junctions only.
  LinePiece next(const LinePiece& p, bool& straight) const {
    const Node node = lines[p.mesh].nodes[p.head()];
    if (node.crossing()) {  // up A turns left along B, down A turns right; and the same with A and B changed over
      const Index turned = p.direction ^ static_cast<Index>(node.kind());
      const Index direction = p.mesh == 0 ? turned : turned ^ 1;
      return {1 - p.mesh, node.index() - direction, direction};
    }
    if (node.kind() == Node::end) return leaving(p.mesh, next_half(node.index()));
    return turn(p, node.index(), straight);
  }
  LinePiece turn(const LinePiece& p, Index junction, bool& straight) const;
  /// The spoke of a junction that has the key, or none.
  Index spoke_with(Index junction, std::uint32_t key) const;
  /// The face of A that holds the corner of a face of B where its half-edge h begins; none when a piece of A divides
  /// it.
  Index face_of_a_after(Index h) const;
};

/// Builds the arrangement. `b_in_a[j]`: where place j of B lies in A. With Refinement::paste what lies inside A leaves
/// no trace, and edges inside A are not followed; with Refinement::outline crossings with B's inner edges leave none.
/// O(n + crossings) expected; the same result for any number of threads.
Arrangement arrange(const CompletedMesh& a, const CompletedMesh& b, Array<Location> b_in_a, Refinement refinement,
                    Context& context);

/// Where a vertex lies exactly.
ExactPlace exact_place(const Arrangement& arrangement, Index vertex);

}  // namespace terrane
