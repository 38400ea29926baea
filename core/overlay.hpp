// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "core/context.hpp"
#include "core/mesh/array.hpp"
#include "core/tin.hpp"

// The common refinement of two TINs in plan: the one place of hard geometry. Everything else folds, filters or
// integrates it.
namespace terrane {

enum class Refinement {
  full,    // faces of A and B cut each other wherever both exist
  paste,   // A covers B: faces of A stay whole but for vertices of B on A's border; B is cut away under A
  outline  // B is one area: its border cuts A's faces, its inner edges do not
};

struct OverlayOptions {
  Refinement refinement = Refinement::full;
  /// Mutually nearest vertices of A and B within this distance become one (A's place is kept). DEFAULT: 4 ulp of the
  /// largest coordinate. 0 switches it off.
  double snap = -1;
};

/// What rounding did, published with every result. Distances in plan, in coordinate units.
struct RoundingReport {
  double max_move = 0;   // delta: the largest distance of a crossing from its exact place
  double max_snap = 0;   // tau: the largest move of an input vertex by snapping
  double max_spill = 0;  // the largest distance of a face's corner from its parent face
  Index snapped = 0;     // vertices moved by snapping
  Index merges = 0;      // crossings that became one because their doubles are equal
  Index flips = 0;       // edges flipped to keep every face positive
  Index kinetic = 0;     // vertices that had to be moved from exact to rounded one by one
  Index lost = 0;        // input vertices that are gone, at the end of faces thinner than rounding
  Index regions = 0;     // regions of the exact topology inside the union of the domains
  Index collapsed = 0;   // of these, how many rounding left without a face
};

struct Overlay {
  Array<Point2> points;  // each place once
  Array<Face> faces;     // counter-clockwise, all strictly positive; they cover the union of the domains
  /// The face of A and of B that a face lies on; `none` outside that domain. With Refinement::outline 0 inside B.
  Array<std::array<Index, 2>> parents;
  /// Heights of A and B: one per point where the input is continuous, else one per corner (3 * face + corner).
  /// Meaningless where the face has no such parent. With Refinement::outline B has none.
  std::array<Array<double>, 2> heights;
  std::array<bool, 2> per_corner = {false, false};
  RoundingReport rounding;

  double height(int input, Index face, int corner) const {
    return heights[input][per_corner[input] ? 3 * static_cast<std::size_t>(face) + corner : faces[face][corner]];
  }
};

/// Overlays A and B. Promises, in the order they are kept:
///  1. Topology is decided by exact predicates on input coordinates; a constructed point never enters a predicate.
///  2. Every vertex is made once: a vertex of A, of B, of both, or the crossing of an edge of A and an edge of B.
///  3. Vertex on vertex, vertex on edge, collinear overlaps and identical faces are cases, not accidents.
///  4. Vertices of A and B are returned bit for bit, except those of B snapped within `snap`. Every returned face is
///     strictly positive, judged exactly on the returned doubles; faces conform; each lies within 3 * max_move + snap
///     of its parents and, where it has none (but under paste), of the outside of that input.
///  5. The same bytes for any thread count, and for any order of faces and vertices that the inputs came in before
///     canonical().
///
/// Precondition: both are valid, as checked() returns them (core/validate); in canonical order it is quickest. Walls
/// are looked through: a vertical face has no area in plan, and heights are kept per corner where an input jumps. Time
/// and memory grow with input + output; what both share costs next to nothing (core/overlay/shared_faces). Throws
/// Error{input, "rounding"} naming the place when the promise cannot be kept. See Jiao & Heath (2004) for the edge
/// walk, and core/rounding/rounding.hpp.
Overlay overlay(const Tin& a, const Tin& b, const OverlayOptions& options, Context& context);

}  // namespace terrane
