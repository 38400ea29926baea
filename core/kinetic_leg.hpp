// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/kinetic_places.hpp"

namespace terrane {

/// A face that becomes flat on the way of a vertex, at the time before / (before + after) of 0 to 1.
struct Event {
  Index face = none;
  Face corners;
  Approximate before, after;  // twice its area at the start, and minus twice its area at the goal
  bool at_end = false;        // after is exactly 0
};

/// How the corners of a flat face lie: one in the middle, or the moving vertex on another.
struct Alignment {
  int middle = none;   // a corner, 0 to 2
  Index meets = none;  // a vertex
};

/// One vertex on a straight way to a double place. Along it every area is linear in time, so two areas of a face, at
/// the start and at the goal, say all about it, and no place on the way need be constructed. All answers are exact.
class Leg {
 public:
  Leg(const KineticPlaces& places, Index vertex, Point2 goal)
      : places_(places), vertex_(vertex), start_(places.at(vertex)), goal_{goal, {}, 0, none} {}

  /// Which faces of the star become flat first, in the order of the star: all at one time.
  void first_events(const PlanarMesh& mesh, const std::vector<Index>& star, std::vector<Event>& events) const;
  /// Is a face, which may have the vertex at a corner, positive at the time of an event?
  bool positive(const Event& now, const Face& face) const;
  Alignment alignment(const Event& now) const;
  /// Where the vertex is then.
  ExactPair position(const Event& now) const;

 private:
  struct Triple {
    NearPlace a, b, c;
  };
  Triple triple(const Face& face, const NearPlace& place) const {
    const auto at = [&](Index v) { return v == vertex_ ? place : places_.at(v); };
    return {at(face[0]), at(face[1]), at(face[2])};
  }
  int sign(const Face& face, const NearPlace& place) const {
    const Triple t = triple(face, place);
    return orientation(places_, t.a, t.b, t.c);
  }
  Approximate area(const Face& face, const NearPlace& place) const {
    const Triple t = triple(face, place);
    return area2(t.a, t.b, t.c);
  }
  Rational exact_area(const Face& face, const NearPlace& place) const {
    const Triple t = triple(face, place);
    return area2(places_.exact(t.a), places_.exact(t.b), places_.exact(t.c));
  }
  int compare_times(const Event& e, const Event& f) const;
  Alignment exact_alignment(const Event& now, int corner) const;

  const KineticPlaces& places_;
  Index vertex_;
  NearPlace start_, goal_;
};

}  // namespace terrane
