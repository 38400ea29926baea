// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/kinetic.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <random>

#include "core/exact_place.hpp"

namespace terrane {
namespace {

using Number = ExactKernel::FT;

Number area2(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

class Kinetic {
 public:
  Kinetic(MeshEditor& editor, const std::function<ExactPlace(Index)>& place) : editor_(editor), place_(place) {}

  void gather(const std::vector<Index>& bad) {
    std::vector<Index> todo = bad, star;
    while (!todo.empty()) {
      const Index f = todo.back();
      todo.pop_back();
      if (sign(f) > 0) continue;
      for (Index v : editor_.mesh().faces[f]) {
        if (moving_.contains(v)) continue;
        const ExactPlace exact = place_(v);
        if (exact.kind == ExactPlace::input) continue;
        const ExactPoint p = exact_point(exact, editor_.mesh().points[v]);
        if (p == rounded_point(v)) continue;
        moving_.emplace(v, p);
        editor_.star(v, star);
        todo.insert(todo.end(), star.begin(), star.end());
      }
    }
  }

  Index run(Context& context) {
    std::vector<Index> todo;
    for (const auto& [v, p] : moving_) todo.push_back(v);
    const Index count = static_cast<Index>(todo.size());
    for (int round = 0; round < 5 && !todo.empty(); ++round) {
      std::vector<Index> rest;
      for (std::size_t i = 0; i < todo.size(); ++i) {
        if ((i & 63) == 0) context.progress("rounding", static_cast<double>(i) / todo.size());
        if (alive(todo[i]) && !move(todo[i])) rest.push_back(todo[i]);
      }
      if (rest.size() == todo.size()) break;
      todo = std::move(rest);
    }
    return count;
  }

 private:
  bool alive(Index v) const { return editor_.merged_into()[v] == v; }
  ExactPoint rounded_point(Index v) const { return {editor_.mesh().points[v].x, editor_.mesh().points[v].y}; }
  ExactPoint at(Index v) const {
    const auto found = moving_.find(v);
    return found == moving_.end() ? rounded_point(v) : found->second;
  }
  int sign(Index f) const {
    const Face& c = editor_.mesh().faces[f];
    return static_cast<int>(CGAL::orientation(at(c[0]), at(c[1]), at(c[2])));
  }
  bool positive(Index a, Index b, Index c) const { return CGAL::orientation(at(a), at(b), at(c)) == CGAL::POSITIVE; }

  /// Straight to the rounded place, or by waypoints within a few ulp of it, seeded by the place itself.
  bool move(Index v) {
    const Point2 goal = editor_.mesh().points[v];
    std::uint64_t bits[2];
    std::memcpy(bits, &goal, sizeof bits);
    std::mt19937_64 dice(bits[0] * 0x9E3779B97F4A7C15ull + bits[1]);
    const auto wobble = [&](double c, double ulps) {
      const double ulp = std::nextafter(std::fabs(c), INFINITY) - std::fabs(c);
      return c + ulp * ulps * (static_cast<double>(dice() % 20001) - 10000) / 10000;
    };
    if (leg(v, ExactPoint(goal.x, goal.y), true)) return true;
    for (int attempt = 0; attempt < 40 && alive(v); ++attempt) {
      const double ulps = attempt < 20 ? 0.5 : 4;
      const ExactPoint waypoint(wobble(goal.x, ulps), wobble(goal.y, ulps));
      if (leg(v, waypoint, false) && (!alive(v) || leg(v, ExactPoint(goal.x, goal.y), true))) return true;
    }
    return !alive(v);
  }

  /// Moves v along a straight line until `target`; false when it must stop before, at a place where all faces are
  /// positive.
  bool leg(Index v, const ExactPoint& target, bool last) {
    std::vector<Index> star, events;
    for (int step = 0; step < 2000; ++step) {
      editor_.star(v, star);
      const Number time = first_event(v, target, star, events);
      if (events.empty()) {
        moving_.at(v) = target;
        return true;
      }
      const ExactPoint from = at(v);
      const bool at_end = time == 1 || from == target;
      ExactPoint stop = at_end ? target : from + (target - from) * time;
      CGAL::exact(stop);  // folds the expression, which would otherwise grow with every event
      Index meets = none;
      for (Index f : star)
        for (Index w : editor_.mesh().faces[f])
          if (w != v && at(w) == stop) meets = w;
      if (meets != none && !(at_end && last)) return false;
      moving_.at(v) = stop;
      if (flip_one(events, meets)) continue;
      if (meets != none && merge_into(v, meets, star)) return true;
      moving_.at(v) = from;
      return false;
    }
    return false;
  }

  /// When the first faces of the star become flat on the way to `target`, as a fraction of it; and which.
  Number first_event(Index v, const ExactPoint& target, const std::vector<Index>& star,
                     std::vector<Index>& events) const {
    events.clear();
    Number first = 2;
    for (Index f : star) {
      const Face& c = editor_.mesh().faces[f];
      const int k = editor_.corner_of(f, v);
      const ExactPoint p = at(c[(k + 1) % 3]), q = at(c[(k + 2) % 3]);
      if (CGAL::orientation(target, p, q) == CGAL::POSITIVE) continue;
      const Number now = area2(at(v), p, q), then = area2(target, p, q);
      const Number time = now <= 0 ? Number(0) : Number(now / (now - then));
      if (time < first) first = time, events.clear();
      if (time == first) events.push_back(f);
    }
    if (!events.empty()) first.exact();
    return first;
  }

  /// Flips the edge opposite the middle vertex of one flat face; faces around a vertex that is about to be merged wait.
  bool flip_one(const std::vector<Index>& events, Index meets) {
    for (Index f : events) {
      const Face c = editor_.mesh().faces[f];
      if (meets != none && (c[0] == meets || c[1] == meets || c[2] == meets)) continue;
      for (int k = 0; k < 3; ++k) {
        if (!CGAL::collinear_are_strictly_ordered_along_line(at(c[(k + 1) % 3]), at(c[k]), at(c[(k + 2) % 3])))
          continue;
        MeshEditor::Quad quad;
        if (editor_.quad(f, k, quad) && positive(quad.u, quad.p, quad.w) && positive(quad.u, quad.w, quad.q)) {
          editor_.flip(f, k, quad);
          return true;
        }
      }
    }
    return false;
  }

  bool merge_into(Index v, Index keep, const std::vector<Index>& star) {
    for (Index f : star)
      for (int k = 0; k < 3; ++k) {
        const Index p = editor_.mesh().faces[f][(k + 1) % 3], q = editor_.mesh().faces[f][(k + 2) % 3];
        if ((p == v && q == keep) || (p == keep && q == v)) return editor_.merge(f, k, keep);
      }
    return false;
  }

  MeshEditor& editor_;
  const std::function<ExactPlace(Index)>& place_;
  std::map<Index, ExactPoint> moving_;
};

}  // namespace

Index move_kinetically(MeshEditor& editor, const std::vector<Index>& bad, const std::function<ExactPlace(Index)>& place,
                       Context& context) {
  Kinetic kinetic(editor, place);
  kinetic.gather(bad);
  return kinetic.run(context);
}

}  // namespace terrane
