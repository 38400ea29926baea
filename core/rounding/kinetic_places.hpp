// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Exact_rational.h>

#include <cmath>
#include <functional>
#include <vector>

#include "core/plan/near_place.hpp"
#include "core/rounding/rounding.hpp"

// Positions of vertices on their way from exact to rounded places, and exact signs of areas on them. Every position is
// a double and an offset about as small as its ulp, so that an area in double-double arithmetic is good to some 25
// digits and decides nearly always; rational numbers decide the rest. Includes CGAL's numbers: for .cpp files of the
// core only.
namespace terrane {

/// A number known to within `error`, which is 0 only when it is known exactly.
struct Approximate {
  double value = 0, error = 0;
  bool decided() const { return std::fabs(value) > error || error == 0; }
  int sign() const { return value > 0 ? 1 : value < 0 ? -1 : 0; }
};

class KineticPlaces {
 public:
  /// `points`: the rounded places.
  KineticPlaces(const Array<Point2>& points, const std::function<ExactPlace(Index)>& place)
      : points_(points), place_(place), slot_(points.size(), none) {}

  /// Puts v back at its exact place; false when that is where it is, or v is fixed.
  bool lift(Index v);
  /// Puts v at a double place.
  void settle(Index v, Point2 where) { places_[slot_[v]] = {where, {}, 0, none}; }
  /// The vertices lifted so far.
  const std::vector<Index>& lifted() const { return lifted_; }

  NearPlace at(Index v) const { return slot_[v] == none ? NearPlace{points_[v], {}, 0, none} : places_[slot_[v]]; }
  /// From the rounded place of v to where it is, rounded.
  Point2 way(Index v) const {
    const NearPlace p = at(v);
    return {p.at.x - points_[v].x + p.offset.x, p.at.y - points_[v].y + p.offset.y};
  }
  ExactPair exact(const NearPlace& place) const;
  /// Is it plain without any arithmetic that three places are collinear? Two may be one, or all lie on one edge, which
  /// is how exact zeros come about.
  bool on_one_line(const NearPlace& a, const NearPlace& b, const NearPlace& c) const;

 private:
  const Array<Point2>& points_;
  const std::function<ExactPlace(Index)>& place_;
  std::vector<Index> slot_;  // of a vertex, among the lifted; none: at points_
  std::vector<Index> lifted_;
  std::vector<NearPlace> places_;
};

/// to - from along one axis, `size` an upper bound of what was added up.
struct Difference {
  double high, low, size;
};
Difference difference(double from, double from_offset, double to, double to_offset);

/// Twice the area of a triangle to about 25 digits of its sides' products, and exactly.
Approximate area2(const NearPlace& a, const NearPlace& b, const NearPlace& c);
Rational area2(const ExactPair& a, const ExactPair& b, const ExactPair& c);
/// Its sign, exact.
int orientation(const KineticPlaces& places, const NearPlace& a, const NearPlace& b, const NearPlace& c);

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
