// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/context.hpp"
#include "core/mesh/array.hpp"
#include "core/tin.hpp"

// A TIN in plan, completed with ghost faces out to a fixed box: holes, bays and the exterior become faces like any
// other, so every walk ends and every place lies in a face.
//
// Notation. A place is a plan position, made once however many heights stand on it. A half-edge h = 4 * face + k (k =
// 0, 1, 2) runs from corner k to corner k + 1 of its face, the face on its left; the fourth number of a face names
// none.
namespace terrane {

inline Index next_half(Index h) { return (h & 3) == 2 ? h - 2 : h + 1; }
inline Index prev_half(Index h) { return (h & 3) == 0 ? h + 2 : h - 1; }

/// A face and what its half-edges lead to, together because they are looked up together.
struct LinkedFace {
  Index corner[3];  // places
  Index twin[3];    // per half-edge the one on the other side; none on the box
  Index edge[3];    // 2 * the number of its edge, + 1 when it runs against the defining one
};

struct CompletedMesh {
  Array<Point2> places;     // those of the TIN's faces, then the four corners of the box
  Array<double> z;          // a height of the TIN at each place; NaN at the corners of the box
  Array<LinkedFace> links;  // the TIN's faces, then the ghosts
  Array<Index> half;        // of an edge: its defining half-edge, from the end lower in x, then y (on the box: the one)
  Array<std::uint8_t> sides;  // of an edge: how many real faces lie beside it; on the box 1, the exterior
  Array<Index> out;           // one half-edge that leaves a place
  Array<Index> face_in_tin;   // face of the TIN behind a real face; empty when all have the TIN's numbers
  Index real_faces = 0;       // faces below this are the TIN's, the others ghosts
  bool jumps = false;         // some place has several heights

  Index faces() const { return static_cast<Index>(links.size()); }
  Index edges() const { return static_cast<Index>(half.size()); }
  Index real_places() const { return static_cast<Index>(places.size()) - 4; }
  bool real(Index face) const { return face < real_faces; }
  Index corner(Index h) const { return links[h >> 2].corner[h & 3]; }
  Index twin(Index h) const { return links[h >> 2].twin[h & 3]; }
  Index edge(Index h) const { return links[h >> 2].edge[h & 3]; }
  Index origin(Index h) const { return corner(h); }
  Index target(Index h) const { return corner(next_half(h)); }
  Index apex(Index h) const { return corner(prev_half(h)); }
  Point2 at(Index place) const { return places[place]; }
  Index edge_of(Index h) const { return edge(h) >> 1; }
  bool against(Index h) const { return edge(h) & 1; }
  /// The face on the left of an edge's defining half-edge (direction 0) or of its twin (1); none outside the box.
  Index left_face(Index e, Index direction) const {
    const Index h = direction == 0 ? half[e] : twin(half[e]);
    return h == none ? none : h >> 2;
  }
  /// The next half-edge counter-clockwise around its origin; none when the box is in the way.
  Index rotate(Index h) const { return twin(prev_half(h)); }
  Index tin_face(Index face) const { return face_in_tin.empty() ? face : face_in_tin[face]; }
};

/// Completes a valid TIN inside `box`, which must hold it with room to spare. `moved[v]`, when given, overrides the
/// plan position of vertex v. Throws Error{input, "overlapping-faces"} when the border crosses itself, and
/// Error{limit, "too-many-faces"} above 250 million. O(n + b log b), b border edges.
CompletedMesh complete(const Tin& tin, const Box& box, const std::vector<Point2>* moved = nullptr);

/// Where a point lies, exactly.
struct Location {
  enum Kind : std::uint8_t { face, edge, place } kind = face;
  Index index = none;  // face number; the defining half-edge; a place
  double z = 0;        // height of the mesh there; NaN outside the TIN; filled in by locate_places() only
};

/// Finds `q`, walking from `hint` (a face). Expected O(1) when the hint is near. `q` must lie in the box.
Location locate(const CompletedMesh& mesh, Point2 q, Index hint);

/// Fills in where every place of `mesh` lies in `other`, for those whose location has no index yet, and how high
/// `other` is there: a convex combination of its heights, never extrapolated, so that a place a rounding error off a
/// steep sliver cannot run away on the sliver's plane. Meaningless where `other` jumps.
void locate_places(const CompletedMesh& mesh, const CompletedMesh& other, Array<Location>& location, Context& context);

/// A face that touches a location, to start the next walk from.
Index face_at(const CompletedMesh& mesh, Location location);

}  // namespace terrane
