// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/error.hpp"
#include "core/mesh/pages.hpp"
#include "core/overlay/arrangement.hpp"
#include "core/overlay/convex.hpp"

// From the lines of an arrangement to its regions, a range of faces at a time.
namespace terrane {

/// A piece of the border of a region that ghost edges cut up.
struct GroupedPiece {
  Index group;
  LinePiece piece;
};

/// What the faces of one range gave, written where room for it was made.
struct Traced {
  Face* faces = nullptr;
  std::array<Index, 2>* parents = nullptr;
  std::size_t room = 0;
  std::size_t count = 0;  // of faces
  std::size_t stop = 0;   // where to ask for more memory
  std::vector<GroupedPiece> grouped;
  Index regions = 0;
  bool all_positive = true;

  void make_room(std::size_t more) {
    if (count + more > stop) open(count + more);
  }
  void add(const Face& face, const std::array<Index, 2>& of) {
    faces[count] = face;
    parents[count++] = of;
  }
  void open(std::size_t needed) {
    if (needed > room) throw Error(ErrorKind::internal, "overlay", "more faces than vertices allow");
    const std::size_t next = next_stop(needed, room);
    populate(faces + count, faces + next);
    populate(parents + count, parents + next);
    stop = next;
  }
};

/// Groups: a face of A without B is its number, a face of B without A comes after those, then the exterior. With
/// Refinement::outline B is one face, 0, and what a face of A has in common with it is a group as well.
struct Groups {
  bool outline;
  Index faces_of_a, exterior;
  Groups(const Arrangement& arrangement, Refinement refinement)
      : outline(refinement == Refinement::outline),
        faces_of_a(arrangement.mesh[0]->faces()),
        exterior(faces_of_a + (outline ? faces_of_a + 1 : arrangement.mesh[1]->faces())) {}
  Index of(Index a, Index b) const {
    if (a == none) return b == none ? exterior : outline ? exterior - 1 : faces_of_a + b;
    return outline && b != none ? faces_of_a + a : a;
  }
  std::array<Index, 2> parents(Index group) const {
    if (group < faces_of_a) return {group, none};
    if (group == exterior) return {none, none};
    if (!outline) return {none, group - faces_of_a};
    return {group == exterior - 1 ? none : group - faces_of_a, 0};
  }
};

/// Traces the regions of a range of faces and triangulates those that are convex.
class RegionTracer {
 public:
  RegionTracer(const Arrangement& arrangement, Refinement refinement, std::span<std::uint8_t> visited, Traced& sink)
      : arrangement_(arrangement),
        a_(*arrangement.mesh[0]),
        b_(*arrangement.mesh[1]),
        groups_(arrangement, refinement),
        paste_(refinement == Refinement::paste),
        outline_(refinement == Refinement::outline),
        visited_(visited),
        points_(arrangement.points.data()),
        sink_(sink) {
    for (int m = 0; m < 2; ++m)
      side_[m] = {arrangement.lines[m].nodes.data(), arrangement.lines[m].first.data(), arrangement.number[m].data(),
                  arrangement.mesh[m]->links.data()};
  }

  /// All regions in a face of A that touch its border.
  void face_of_a(Index f);

  /// A face of B that no piece of A touches or enters lies in one face of A.
  void face_of_b(Index g);

  /// A whole face of m, with the vertices of the other mesh that stay on its edges.
  void whole(int m, Index f, std::array<Index, 2> parents);

 private:
  std::array<Index, 3> corners_of(const CompletedMesh& mesh, int m, Index f) const;

  /// What a face of B is as a parent.
  Index parent_in_b(Index g) const { return !b_.real(g) ? none : outline_ ? 0 : g; }

  /// Follows the border of the region to the left of a piece of face f of A.
  void trace(Index f, const LinePiece& start);

  /// The same where there is nothing to it but corners: the innermost loop of the overlay. It walks to and fro between
  /// pieces of A and of B as if at random, so the mesh is a number to look up with and not to branch on.
  void trace_in_both(Index f, Index g, const LinePiece& start);
  void visit(const LinePiece& piece);

  void emit_convex(Index a, Index b, std::span<const Index> corners, std::span<const std::uint8_t> straight);

  /// The edge of face f of mesh m that a piece is part of.
  Index edge_of(int m, Index f, const LinePiece& piece) const;

  /// Notes a piece of the border of a region outside A or B, unless it is a ghost edge's.
  void group(Index f, Index g, const LinePiece& piece);

  const Arrangement& arrangement_;
  const CompletedMesh &a_, &b_;
  Groups groups_;
  bool paste_, outline_;
  std::span<std::uint8_t> visited_;
  const Point2* points_;
  struct Side {
    const Node* nodes;
    const Index *first, *number;
    const LinkedFace* faces;
  } side_[2];
  Traced& sink_;
  std::vector<Index> corners_, whole_corners_;  // buffers
  std::vector<std::uint8_t> straight_, whole_straight_;
  ConvexTriangulator triangulator_;
};

}  // namespace terrane
