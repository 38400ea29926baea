// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay/snapping.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/predicates.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

/// Finds the places of A near others. They may be corners of faces that their own does not touch: slivers lie between.
class Vicinity {
 public:
  Vicinity(const CompletedMesh& a, double tolerance) : a_(a), tolerance_(tolerance) {}

  /// Is q, in the face, certainly farther from its sides than the tolerance?
  bool deep_inside(Index face, Point2 q) const {
    for (int k = 0; k < 3; ++k) {
      const Point2 from = a_.at(a_.corner(4 * face + k)), to = a_.at(a_.corner(4 * face + (k + 1) % 3));
      const double ux = to.x - from.x, uy = to.y - from.y;
      const double l = ux * (q.y - from.y), r = uy * (q.x - from.x);
      if (l - r <= 2 * tolerance_ * (std::fabs(ux) + std::fabs(uy)) + 1e-15 * (std::fabs(l) + std::fabs(r)))
        return false;
    }
    return true;
  }

  /// Calls visit(place of A, distance) for each place within the tolerance of q.
  template <class Visit>
  void each(Location where, Point2 q, Visit visit) {
    const Index start = face_at(a_, where);
    if (seen_.empty()) seen_.assign(a_.faces(), 0);
    ++round_;
    faces_.clear();
    places_.clear();
    const auto reach = [&](Index face) {
      if (std::exchange(seen_[face], round_) != round_) faces_.push_back(face);
    };
    reach(start);
    for (std::size_t n = 0; n < faces_.size(); ++n)
      for (int k = 0; k < 3; ++k) {
        const Index h = 4 * faces_[n] + k, i = a_.corner(h);
        if (beside(a_.at(i), a_.at(i), q, tolerance_) && i < a_.real_places()) places_.push_back(i);
        if (a_.twin(h) != none && near_edge(a_.at(i), a_.at(a_.target(h)), q)) reach(a_.twin(h) >> 2);
      }
    std::sort(places_.begin(), places_.end());
    places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
    for (Index i : places_)
      if (const double d = std::hypot(a_.at(i).x - q.x, a_.at(i).y - q.y); d <= tolerance_) visit(i, d);
  }

 private:
  /// Is q in the box around a and b, widened by `margin`?
  static bool beside(Point2 a, Point2 b, Point2 q, double margin) {
    return std::min(a.x, b.x) - margin <= q.x && q.x <= std::max(a.x, b.x) + margin &&
           std::min(a.y, b.y) - margin <= q.y && q.y <= std::max(a.y, b.y) + margin;
  }

  bool near_edge(Point2 a, Point2 b, Point2 q) const {
    if (!beside(a, b, q, 2 * tolerance_)) return false;
    if (beside(a, a, q, tolerance_) || beside(b, b, q, tolerance_)) return true;  // beside a place, nearly always
    double d;
    nearest_on_segment(a, b, q, d);
    return d <= 2 * tolerance_;
  }

  const CompletedMesh& a_;
  double tolerance_;
  std::vector<Index> faces_, places_;
  std::vector<std::uint32_t> seen_;  // of a face: the last round that reached it
  std::uint32_t round_ = 0;
};

bool positive(const CompletedMesh& mesh, const Array<Point2>& at, Index f) {
  return orientation(at[mesh.corner(4 * f)], at[mesh.corner(4 * f + 1)], at[mesh.corner(4 * f + 2)]) > 0;
}

}  // namespace

Snapped snap_places(const Tin& b, const Box& frame, CompletedMesh completed, const CompletedMesh& a, double tolerance,
                    Context& context) {
  Snapped result;
  result.location.assign(completed.places.size(), {});
  locate_places(completed, a, result.location, context);
  result.mesh = std::move(completed);
  const CompletedMesh& mesh = result.mesh;
  const Index n = static_cast<Index>(mesh.places.size());
  if (tolerance == 0) return result;

  // The nearest of the other mesh, of every place that has one within reach; in doubt the lower number.
  std::vector<Index> partner(n, none), owner(a.places.size(), none);
  for (Index j = 0; j < n; ++j)
    if (result.location[j].kind == Location::place) owner[result.location[j].index] = j;
  const auto distance = [&](Index i, Index j) {
    return std::hypot(a.at(i).x - mesh.at(j).x, a.at(i).y - mesh.at(j).y);
  };
  Vicinity vicinity(a, tolerance);
  // Nearly all lie deep inside a face or on a place; the others are looked at one by one.
  const std::size_t places = static_cast<std::size_t>(mesh.real_places());
  Array<std::uint8_t> beside(places);
  parallel_for(context, places, chunk_for(context, places), [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      const Location& where = result.location[j];
      beside[j] = where.kind == Location::edge ||
                  (where.kind == Location::face && !vicinity.deep_inside(where.index, mesh.at(static_cast<Index>(j))));
    }
  });
  std::vector<Index> near;  // places of B with a partner
  for (Index j = 0; j < mesh.real_places(); ++j) {
    if (!beside[j]) continue;
    double nearest = std::numeric_limits<double>::infinity();
    vicinity.each(result.location[j], mesh.at(j), [&](Index i, double d) {
      if (d < nearest) nearest = d, partner[j] = i;
      if (owner[i] == none || d < distance(i, owner[i])) owner[i] = j;
    });
    if (partner[j] != none) near.push_back(j);
  }
  bool any = false;
  for (Index j : near) {
    if (owner[partner[j]] != j) partner[j] = none;
    any = any || partner[j] != none;
  }
  if (!any) return result;

  Array<Point2> at = mesh.places;
  for (Index j = 0; j < n; ++j)
    if (partner[j] != none) at[j] = a.at(partner[j]);
  for (bool changed = true; changed;) {  // a face that would not stay positive keeps its corners where they were
    changed = false;
    for (Index f = 0; f < mesh.real_faces; ++f) {
      if (positive(mesh, at, f)) continue;
      for (int k = 0; k < 3; ++k) {
        const Index j = mesh.corner(4 * f + k);
        if (partner[j] == none) continue;
        partner[j] = none;
        at[j] = mesh.at(j);
        changed = true;
      }
    }
  }
  std::vector<Point2> moved(b.vertices.size());
  for (std::size_t v = 0; v < moved.size(); ++v) moved[v] = plan(b.vertices[v]);
  for (Index f = 0; f < mesh.real_faces; ++f)
    for (int k = 0; k < 3; ++k) moved[b.faces[mesh.tin_face(f)][k]] = at[mesh.corner(4 * f + k)];
  try {
    CompletedMesh snapped = complete(b, frame, &moved);
    if (snapped.places.size() != mesh.places.size()) return result;  // two became one: leave B alone
    for (Index j = 0; j < n; ++j)
      if (partner[j] != none) {
        ++result.count;
        result.max_move = std::max(result.max_move, distance(partner[j], j));
        result.location[j] = {Location::place, partner[j], a.z[partner[j]]};
      }
    result.mesh = std::move(snapped);
  } catch (const Error&) {
    // The snapped border would cross itself: B stays as it came.
  }
  return result;
}

}  // namespace terrane
