// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/context.hpp"
#include "core/mesh/half_edges.hpp"
#include "core/tin.hpp"

// How far a coarser surface on some of the vertices of a TIN is from it, vertically. Both are linear between vertices
// and the places where their edges cross, so the difference is largest at one of these.
namespace terrane {

class Deviation {
 public:
  /// Keeps references to both. Precondition: `mesh` is half_edges(tin) and the TIN is valid.
  Deviation(const Tin& tin, const HalfEdges& mesh) : tin_(tin), mesh_(mesh) {}

  /// The largest vertical distance between the straight line from vertex p to vertex q and the surface under it; once
  /// that exceeds `limit`, only that it does. Infinite where the line leaves the domain. Exact predicates find the way,
  /// through vertices and along edges too. Time grows with the edges crossed.
  double along(Index p, Index q, double limit) const;

  /// That of vertex v from the plane of a face of the coarser surface (counter-clockwise) that covers it.
  double at(Index v, Index a, Index b, Index c) const;

  Point2 place(Index v) const { return plan(tin_.vertices[v]); }
  double z(Index v) const { return tin_.vertices[v].z; }

 private:
  struct Way {
    Index vertex = none;     // reached, or
    Index half_edge = none;  // crossed from the face on its left
  };
  Way leave(Index at, Index q) const;
  Way leave_fan(Index first, Index at, Index q) const;

  const Tin& tin_;
  const HalfEdges& mesh_;
};

/// The largest vertical distance between two surfaces where both exist, measured on their overlay: it shares nothing
/// with how the one was made of the other. Time and memory of an overlay.
double largest_difference(const Tin& a, const Tin& b, Context& context);

}  // namespace terrane
