// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/context.hpp"
#include "core/mesh/array.hpp"
#include "core/tin.hpp"

// How the faces of any TIN, good or bad, lie beside each other in plan: what validation and the certificate are made
// of. A place is a point of the plane; vertices at one place may have different heights. A half-edge is 3 * face +
// corner and runs counter-clockwise along its face, whichever way the face itself is written.
namespace terrane {

enum class Turn : std::int8_t {
  left,     // counter-clockwise: positive area in plan
  right,    // clockwise
  wall,     // vertical, of area in space: two corners at one place and different heights, the third elsewhere
  flat,     // no area in plan and no wall
  unusable  // an index out of range, or a corner that is not finite
};

/// mate[h] when half-edge h has no partner, and when its face has no area in plan.
inline constexpr Index no_mate = -1, no_half_edge = -2;

struct PlanTopology {
  Array<Index> place;         // per vertex: the lowest vertex at the same x and y
  Array<Turn> turn;           // per face
  Array<Index> mate;          // per half-edge: the one that runs the other way between the same two places
  std::vector<Index> border;  // the half-edges without a mate, in order
  std::vector<std::array<Index, 2>> crowded;  // plan edges (lower, higher place) used by two faces on one side

  bool in_plan(Index face) const { return turn[face] == Turn::left || turn[face] == Turn::right; }
  /// The vertices a half-edge runs from and to.
  Index from(const Tin& tin, Index h) const { return end(tin, h, false); }
  Index to(const Tin& tin, Index h) const { return end(tin, h, true); }
  /// The half-edge that follows h around its face.
  Index next(Index h) const {
    const Index corner = h % 3, step = turn[h / 3] == Turn::right ? 2 : 1;
    return h - corner + (corner + step) % 3;
  }

 private:
  Index end(const Tin& tin, Index h, bool head) const {
    const Index corner = h % 3;
    const bool step = head == (turn[h / 3] != Turn::right);
    return tin.faces[h / 3][step ? (corner + 1) % 3 : corner];
  }
};

/// The lowest vertex at the place of each vertex. Vertices that are not finite are places of their own. O(n) for a
/// TIN in canonical order, else O(n log n).
Array<Index> places(const std::vector<Point>& vertices, const Context& context = {});

/// Never throws but for memory; no precondition. O(n log d) for vertices of up to d edges; in canonical order, where
/// all that meets lies near in memory, about 50 ns per face.
PlanTopology plan_topology(const Tin& tin, const Context& context = {});
PlanTopology plan_topology(const Tin& tin, Array<Index> places, const Context& context = {});

/// A half-edge without a mate and the places it runs between, the domain on its left.
struct BorderHalfEdge {
  Index half_edge, from, to;
};

/// The border of a topology, in the order of its half-edges.
std::vector<BorderHalfEdge> border_edges(const Tin& tin, const PlanTopology& topology);

/// The same without a topology, in a fraction of its time and memory, for a TIN as results and most inputs are: in
/// canonical order, every face positive, no edge with two faces on one side, no place with two vertices of the border.
/// None for any other TIN. Vertices are taken for places. That is right when examine_border() finds the border without
/// fault: two fans of faces at one place would cover it twice, unless both lie on the border.
std::optional<std::vector<BorderHalfEdge>> sound_border(const Tin& tin, const Context& context = {});

/// What the border says about the faces inside it. With every face positive, the number of faces over a place is the
/// winding number of the border around it, so faces overlap exactly where that is neither 0 nor 1.
struct BorderReport {
  struct Touch {
    Index half_edge, place;  // the place lies on the half-edge, strictly between its ends
  };
  std::vector<Touch> touches;                  // T-junctions, by half-edge and along it
  std::size_t crossings = 0;                   // border edges that cut another one
  std::vector<std::array<Index, 2>> crossing;  // half-edges that cross, at most `limit`
  std::size_t doubled_regions = 0;             // of the plane, where faces overlap; not counted when borders cross
  std::vector<std::array<Point2, 3>> doubled;  // triangles inside them, at most `limit`

  bool sound() const { return touches.empty() && crossings == 0 && doubled_regions == 0; }
};

/// Exact: a constrained Delaunay triangulation of the border alone. About 3 us per border edge.
BorderReport examine_border(const Tin& tin, std::span<const BorderHalfEdge> border, std::size_t limit);

}  // namespace terrane
