// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rounding/kinetic.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "core/rounding/kinetic_places.hpp"

namespace terrane {
namespace {

class Kinetic {
 public:
  Kinetic(MeshEditor& editor, const std::function<ExactPlace(Index)>& place)
      : editor_(editor), place_(place), places_(editor.mesh().points, place) {}

  /// Puts the vertices of bad faces, and of every face that this spoils, back; false when there was none to put back.
  bool gather(const std::vector<Index>& bad) {
    const std::size_t before = places_.lifted().size();
    std::vector<Index> todo = bad;
    while (!todo.empty()) {
      const Index f = todo.back();
      todo.pop_back();
      const Face& c = editor_.mesh().faces[f];
      if (orientation(places_, places_.at(c[0]), places_.at(c[1]), places_.at(c[2])) > 0) continue;
      for (Index v : c)
        if (places_.lift(v)) {
          editor_.star(v, star_);
          todo.insert(todo.end(), star_.begin(), star_.end());
        }
    }
    return places_.lifted().size() > before;
  }

  KineticMoves run(Context& context) {
    std::vector<Index> todo = nearest_first();
    std::size_t known = todo.size();
    for (int round = 0; round < 5 && !todo.empty(); ++round) {
      std::vector<Index> rest;
      for (std::size_t i = 0; i < todo.size(); ++i) {
        if ((i & 4095) == 0) context.progress("rounding", static_cast<double>(i) / todo.size());
        if (alive(todo[i]) && !move(todo[i])) rest.push_back(todo[i]);
        const std::vector<Index>& lifted = places_.lifted();
        while (known < lifted.size()) todo.push_back(lifted[known++]);
      }
      if (rest.size() == todo.size()) break;
      todo = std::move(rest);
    }
    double shift = 0;
    for (Index v : todo) {
      if (!alive(v)) continue;
      if (place_(v).kind != ExactPlace::lattice) shift = std::max(shift, move_beside(v));
    }
    return {static_cast<Index>(known), shift};
  }

 private:
  /// Crossings of one edge that round to one place stand in a row before it: from the front none has to go around
  /// another.
  std::vector<Index> nearest_first() const {
    std::vector<std::pair<double, Index>> order;
    for (Index v : places_.lifted()) {
      const Point2 way = places_.way(v);
      order.emplace_back(way.x * way.x + way.y * way.y, v);
    }
    std::sort(order.begin(), order.end());
    std::vector<Index> todo;
    for (const auto& [distance, v] : order) todo.push_back(v);
    return todo;
  }

  bool alive(Index v) const { return editor_.merged_into()[v] == v; }

  /// Straight to the rounded place, or by waypoints about as far from it as the vertex is, seeded by the place itself.
  bool move(Index v) {
    const Point2 goal = editor_.mesh().points[v];
    const Point2 way = places_.way(v);
    if (leg(v, goal, true)) return true;
    std::uint64_t bits[2];
    std::memcpy(bits, &goal, sizeof bits);
    std::mt19937_64 dice(bits[0] * 0x9E3779B97F4A7C15ull + bits[1]);
    const auto wobble = [&](double c, double way, double reach) {
      const double ulp = std::nextafter(std::fabs(c), INFINITY) - std::fabs(c);
      return c + std::max(ulp, std::fabs(way)) * reach * (static_cast<double>(dice() % 20001) - 10000) / 10000;
    };
    for (int attempt = 0; attempt < 40 && alive(v); ++attempt) {
      const double reach = attempt < 20 ? 0.5 : 4;
      const double x = wobble(goal.x, way.x, reach), y = wobble(goal.y, way.y, reach);
      if (leg(v, {x, y}, false) && (!alive(v) || leg(v, goal, true))) return true;
    }
    return !alive(v);
  }

  /// Where no way leads to the rounded place, one mostly leads to a double beside it, which then is the rounded place.
  /// Returns how far beside, or 0 when none does.
  double move_beside(Index v) {
    Point2& rounded = editor_.mesh().points[v];
    const Point2 before = rounded;
    const auto ulps = [](double c, int n) {
      for (; n > 0; --n) c = std::nextafter(c, INFINITY);
      for (; n < 0; ++n) c = std::nextafter(c, -INFINITY);
      return c;
    };
    for (int reach = 1; reach <= 3; ++reach)
      for (int dx = -reach; dx <= reach; ++dx)
        for (int dy = -reach; dy <= reach; ++dy) {
          if (std::max(std::abs(dx), std::abs(dy)) < reach) continue;
          rounded = {ulps(before.x, dx), ulps(before.y, dy)};
          if (leg(v, rounded, true)) return std::hypot(rounded.x - before.x, rounded.y - before.y);
        }
    rounded = before;
    return 0;
  }

  /// Moves v along a straight line to `goal`, or not at all: a stop on the way would be a rational place, and places
  /// made of such places grow without bound.
  bool leg(Index v, Point2 goal, bool last) {
    const Leg leg(places_, v, goal);
    const MeshEditor::Mark mark = editor_.mark();
    const auto back = [&] {
      editor_.undo(mark);
      return false;
    };
    for (int step = 0; step < 2000; ++step) {
      editor_.star(v, star_);
      leg.first_events(editor_.mesh(), star_, events_);
      if (events_.empty()) {
        places_.settle(v, goal);
        return true;
      }
      alignments_.clear();
      Index meets = none;
      for (const Event& e : events_) {
        alignments_.push_back(leg.alignment(e));
        if (alignments_.back().meets != none) meets = alignments_.back().meets;
      }
      if (meets != none && !(events_[0].at_end && last)) return back();
      if (flip_one(leg, meets)) continue;
      if (meets == none || !merge_into(v, meets)) return back();
      return true;
    }
    return back();
  }

  /// Flips the edge opposite the middle vertex of one flat face. Faces around a vertex that is about to be merged wait.
  /// The face across may be a bad one that was to be left to others: then its vertices join those that move.
  bool flip_one(const Leg& leg, Index meets) {
    for (std::size_t i = 0; i < events_.size(); ++i) {
      const Event& e = events_[i];
      if (meets != none && (e.corners[0] == meets || e.corners[1] == meets || e.corners[2] == meets)) continue;
      MeshEditor::Quad quad;
      const int k = alignments_[i].middle;
      if (k == none) continue;
      if (!editor_.quad(e.face, k, quad)) continue;
      if (leg.positive(e, {quad.u, quad.p, quad.w}) && leg.positive(e, {quad.u, quad.w, quad.q})) {
        editor_.flip(e.face, k, quad);
        return true;
      }
      if (gather({quad.g})) return true;
    }
    return false;
  }

  bool merge_into(Index v, Index keep) {
    for (Index f : star_)
      for (int k = 0; k < 3; ++k) {
        const Index p = editor_.mesh().faces[f][(k + 1) % 3], q = editor_.mesh().faces[f][(k + 2) % 3];
        if ((p == v && q == keep) || (p == keep && q == v)) return editor_.merge(f, k, keep);
      }
    return false;
  }

  MeshEditor& editor_;
  const std::function<ExactPlace(Index)>& place_;
  KineticPlaces places_;
  std::vector<Index> star_;
  std::vector<Event> events_;
  std::vector<Alignment> alignments_;
};

}  // namespace

KineticMoves move_kinetically(MeshEditor& editor, const std::vector<Index>& bad,
                              const std::function<ExactPlace(Index)>& place, Context& context) {
  Kinetic kinetic(editor, place);
  kinetic.gather(bad);
  return kinetic.run(context);
}

}  // namespace terrane
