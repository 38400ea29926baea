// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "core/tin.hpp"

// A TIN in plan, completed with ghost faces out to a fixed box: holes, bays and the exterior become faces like any
// other, so every walk ends and every place lies in a face.
//
// Notation. A place is a plan position, made once however many heights stand on it. A half-edge h = 4 * face + k (k =
// 0, 1, 2) runs from corner k to corner k + 1 of its face, the face on its left; the fourth slot of a face is unused
// padding.
namespace terrane {

inline Index next_half(Index h) { return (h & 3) == 2 ? h - 2 : h + 1; }
inline Index prev_half(Index h) { return (h & 3) == 0 ? h + 2 : h - 1; }

struct CompletedMesh {
  std::vector<Point2> places;      // those of the TIN, then the four corners of the box
  std::vector<Index> corner;       // place at the origin of a half-edge
  std::vector<Index> twin;         // the half-edge on the other side; none on the box
  std::vector<Index> edge;         // number of the undirected edge of a half-edge
  std::vector<Index> half;         // its defining half-edge: the first of the two
  std::vector<Index> out;          // one half-edge that leaves a place
  std::vector<Index> face_in_tin;  // face of the TIN behind a real face (walls have none here)
  std::vector<Index> vertex;       // TIN vertex at the corner of a real face: vertex[3 * face + k]
  std::vector<Index> any_vertex;   // one TIN vertex at a place; none at the box corners
  Index real_faces = 0;            // faces below this are the TIN's, the others ghosts
  bool jumps = false;              // some place has several heights

  Index faces() const { return static_cast<Index>(corner.size() / 4); }
  Index real_places() const { return static_cast<Index>(places.size()) - 4; }
  bool real(Index face) const { return face < real_faces; }
  Index origin(Index h) const { return corner[h]; }
  Index target(Index h) const { return corner[next_half(h)]; }
  Index apex(Index h) const { return corner[prev_half(h)]; }
  Point2 at(Index place) const { return places[place]; }
  /// The next half-edge counter-clockwise around its origin; none when the box is in the way.
  Index rotate(Index h) const { return twin[prev_half(h)]; }
};

/// Completes a valid TIN inside `box`, which must hold it with room to spare. `moved[v]`, when given, overrides the
/// plan position of vertex v. Throws Error{input, "overlapping-faces"} when the border crosses itself. O(n + b log b),
/// b border edges.
CompletedMesh complete(const Tin& tin, const Box& box, const std::vector<Point2>* moved = nullptr);

/// Where a point lies, exactly.
struct Location {
  enum Kind : std::uint8_t { face, edge, place } kind = face;
  Index index = none;  // face number; a half-edge; a place
};

/// Finds `q`, walking from `hint` (a face). Expected O(1) when the hint is near. `q` must lie in the box.
Location locate(const CompletedMesh& mesh, Point2 q, Index hint);

/// A face that touches a location, to start the next walk from.
Index face_at(const CompletedMesh& mesh, Location location);

}  // namespace terrane
