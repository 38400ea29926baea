// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/overlay_judge.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "support/exact.hpp"
#include "support/height_judge.hpp"
#include "support/overlay_cover.hpp"
#include "support/plan_mesh.hpp"

namespace terrane::support {
namespace {

using Place = std::pair<double, double>;

/// Distances below it are not told apart: a product of two of them is none that doubles hold.
constexpr double denormal = 1e-300;

Place key(Point2 p) { return {p.x, p.y}; }

/// Sorted: small sets of them are looked at by the million.
class Places {
 public:
  Places() = default;
  explicit Places(std::span<const Point2> points) {
    for (const Point2 p : points) sorted_.push_back(key(p));
    std::sort(sorted_.begin(), sorted_.end());
  }
  bool contains(Point2 p) const { return std::binary_search(sorted_.begin(), sorted_.end(), key(p)); }

 private:
  std::vector<Place> sorted_;
};

using Segment = std::array<Point2, 2>;

/// Each edge once.
std::vector<Segment> edges_of(const PlanMesh& mesh) {
  std::vector<std::pair<Index, Index>> ends;
  for (const Face& f : mesh.faces)
    for (int k = 0; k < 3; ++k) ends.push_back(std::minmax(f[k], f[(k + 1) % 3]));
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  std::vector<Segment> edges;
  for (const auto& [u, v] : ends) edges.push_back({mesh.points[u], mesh.points[v]});
  return edges;
}

/// Whether p lies within `reach` of the crossing of two lines; false when they are parallel.
bool near_crossing(Point2 p, const Segment& s, const Segment& t, double reach) {
  using Real = long double;
  const Real ux = Real(s[1].x) - s[0].x, uy = Real(s[1].y) - s[0].y, vx = Real(t[1].x) - t[0].x,
             vy = Real(t[1].y) - t[0].y, wx = Real(t[0].x) - s[0].x, wy = Real(t[0].y) - s[0].y;
  const Real across = ux * vy - uy * vx, along = (wx * vy - wy * vx) / across;
  const Real distance = length(s[0].x - Real(p.x) + along * ux, s[0].y - Real(p.y) + along * uy);
  const Real doubt =
      2e-18L * (std::fabs(ux) + std::fabs(uy)) *
      (2 + (std::fabs(wx * vy) + std::fabs(wy * vx) + std::fabs(ux * vy) + std::fabs(uy * vx)) / std::fabs(across));
  if (distance + doubt <= reach) return true;
  if (distance - doubt > reach) return false;
  const mpq_class eux = mpq_class(s[1].x) - s[0].x, euy = mpq_class(s[1].y) - s[0].y;
  const mpq_class evx = mpq_class(t[1].x) - t[0].x, evy = mpq_class(t[1].y) - t[0].y;
  const mpq_class ewx = mpq_class(t[0].x) - s[0].x, ewy = mpq_class(t[0].y) - s[0].y;
  const mpq_class exact_across = eux * evy - euy * evx;
  if (exact_across == 0) return false;
  const mpq_class at = (ewx * evy - ewy * evx) / exact_across;
  const mpq_class dx = mpq_class(s[0].x) - p.x + at * eux, dy = mpq_class(s[0].y) - p.y + at * euy;
  return dx * dx + dy * dy <= mpq_class(reach) * mpq_class(reach);
}

class Judge {
 public:
  Judge(const Tin& a, const Tin& b, const OverlayOptions& options, const Overlay& overlay)
      : inputs_{&a, &b}, options_(options), overlay_(overlay) {
    for (const int m : {0, 1}) meshes_[m] = plan_mesh(*inputs_[m]), places_[m] = Places(meshes_[m].points);
    wrong_.precision(17);
  }

  std::string judged() {
    judge_presence();
    judge_moves();
    judge_parents();
    judge_heights();
    return wrong_.str();
  }

 private:
  /// Every vertex is there, but for those reported: at the end of faces, or of tips of faces over the other's border,
  /// that are thinner than what rounding moves.
  void judge_presence() {
    const Places there(overlay_.points);
    const double reach = 3 * overlay_.rounding.max_move + denormal;
    std::set<Place> missing;
    for (const int m : {0, 1}) {
      if (m == 1 && options_.refinement == Refinement::paste) continue;
      for (const Face& f : meshes_[m].faces)
        for (int k = 0; k < 3; ++k) {
          const Point2 p = meshes_[m].points[f[k]];
          if (there.contains(p)) continue;
          missing.insert(key(p));
          if (tip_thickness(m, f, k) > reach)
            wrong_ << "vertex " << p.x << " " << p.y << " of input " << m << " is gone; ";
        }
    }
    if (missing.size() > static_cast<std::size_t>(overlay_.rounding.lost))
      wrong_ << missing.size() << " vertices are gone, " << overlay_.rounding.lost << " reported; ";
  }

  /// Of face f from its corner k up to the border of the other input.
  double tip_thickness(int m, const Face& f, int k) const {
    using Real = long double;
    const Point2 p = meshes_[m].points[f[k]];
    const PlanMesh& other = meshes_[1 - m];
    Real side[2][2];
    for (const int i : {0, 1}) {
      const Point2 q = meshes_[m].points[f[(k + 1 + i) % 3]];
      const Real dx = Real(q.x) - p.x, dy = Real(q.y) - p.y;
      Real until = 1;
      for (const auto& [u, v] : border_of(other.faces)) {
        const Point2 s = other.points[u], t = other.points[v];
        if (turn(p, q, s) * turn(p, q, t) > 0 || turn(s, t, p) * turn(s, t, q) >= 0) continue;
        // Exactly: p may be hundreds of orders of magnitude nearer to the border than to its ends.
        const mpq_class from = area2_exact(s, t, p), along = from / (from - area2_exact(s, t, q));
        until = std::min<Real>(until, along.get_d());
      }
      side[i][0] = until * dx, side[i][1] = until * dy;
    }
    const Real longest = std::max({length(side[0][0], side[0][1]), length(side[1][0], side[1][1]),
                                   length(side[0][0] - side[1][0], side[0][1] - side[1][1])});
    return static_cast<double>(std::fabs(side[0][0] * side[1][1] - side[0][1] * side[1][0]) / longest);
  }

  /// Every other vertex is the crossing of two edges, within max_move.
  void judge_moves() {
    const std::vector<Segment> edges[2] = {edges_of(meshes_[0]), edges_of(meshes_[1])};
    const double reach = overlay_.rounding.max_move + denormal;
    std::vector<const Segment*> near[2];
    for (const Point2 p : overlay_.points) {
      if (places_[0].contains(p) || places_[1].contains(p)) continue;
      for (const int m : {0, 1}) {
        near[m].clear();
        for (const Segment& e : edges[m])
          if (p.x >= std::min(e[0].x, e[1].x) - reach && p.x <= std::max(e[0].x, e[1].x) + reach &&
              p.y >= std::min(e[0].y, e[1].y) - reach && p.y <= std::max(e[0].y, e[1].y) + reach &&
              within(p, e[0], e[1], reach))
            near[m].push_back(&e);
      }
      bool found = false;
      for (const Segment* s : near[0])
        for (const Segment* t : near[1]) found = found || near_crossing(p, *s, *t, reach);
      if (!found) wrong_ << "vertex " << p.x << " " << p.y << " is no crossing within " << reach << "; ";
    }
  }

  void judge_parents() {
    const RoundingReport& report = overlay_.rounding;
    if (!(report.max_spill <= 3 * report.max_move + report.max_snap))
      wrong_ << "a spill above 3 max_move is reported; ";
    const double spill = std::min(3 * report.max_move, report.max_spill) + denormal;  // of what snapping has moved
    for (std::size_t f = 0; f < overlay_.faces.size(); ++f)
      for (const int m : {0, 1}) {
        const Index parent = overlay_.parents[f][m];
        if (parent == none) {
          judge_outside(f, m, spill);
          continue;
        }
        const Triangle t = triangle(*inputs_[m], parent);
        for (const Index v : overlay_.faces[f])
          if (!within(overlay_.points[v], t, spill))
            wrong_ << "face " << f << " spills at " << overlay_.points[v].x << " " << overlay_.points[v].y
                   << " from face " << parent << " of input " << m << "; ";
      }
  }

  /// A face without a parent reaches no farther into that input than spills go; but a pasted A lies on B.
  void judge_outside(std::size_t f, int m, double spill) {
    if (m == 1 && options_.refinement == Refinement::paste && overlay_.parents[f][0] != none) return;
    const PlanMesh& mesh = meshes_[m];
    const auto border = border_of(mesh.faces);
    for (const Index v : overlay_.faces[f]) {
      const Point2 p = overlay_.points[v];
      const bool inside = std::any_of(mesh.faces.begin(), mesh.faces.end(),
                                      [&](const Face& g) { return within(p, triangle(mesh.points, g), 0); });
      const bool beside = std::any_of(border.begin(), border.end(), [&](const auto& edge) {
        return within(p, mesh.points[edge.first], mesh.points[edge.second], spill);
      });
      if (inside && !beside)
        wrong_ << "face " << f << " of outside input " << m << " reaches into it at " << p.x << " " << p.y << "; ";
    }
  }

  const Point* corner_at(int m, Index face, Point2 p) const {
    for (const Index v : inputs_[m]->faces[face])
      if (plan(inputs_[m]->vertices[v]) == p) return &inputs_[m]->vertices[v];
    return nullptr;
  }

  void judge_heights() {
    const RoundingReport& report = overlay_.rounding;
    // A vertex lies as far from its face as spills go, and has the height of the nearest place there.
    const double spill = std::min(3 * report.max_move, report.max_spill);
    const double radius = std::max(2 * report.max_move, spill) + 2 * report.max_snap + denormal;
    for (const int m : {0, 1}) {
      const HeightJudge judge(*inputs_[m]);
      std::map<Place, std::pair<double, bool>> own;  // of vertices of the input: the height, and whether it is the one
      for (const Face& f : inputs_[m]->faces)
        for (const Index v : f) {
          const Point& p = inputs_[m]->vertices[v];
          const auto at = own.try_emplace({p.x, p.y}, p.z, true);
          at.first->second.second = at.first->second.second && at.first->second.first == p.z;
        }
      std::vector<std::pair<Index, double>> seen;  // a vertex and the height it was last right with
      seen.resize(overlay_.points.size(), {none, 0});
      for (Index f = 0; f < static_cast<Index>(overlay_.faces.size()); ++f) {
        const Index parent = overlay_.parents[f][m];
        if (parent == none) continue;
        for (int k = 0; k < 3; ++k) {
          const Index v = overlay_.faces[f][k];
          const Point2 p = overlay_.points[v];
          const double z = overlay_.height(m, f, k);
          if (seen[v].first != none && seen[v].second == z) continue;
          seen[v] = {v, z};
          // Under a pasted A nothing of B is a vertex.
          const bool vertices = m == 0 || options_.refinement == Refinement::full;
          if (const Point* corner = corner_at(m, parent, p); corner && vertices && z != corner->z)
            wrong_ << "height " << z << " at corner " << p.x << " " << p.y << " of face " << parent << " of input " << m
                   << " instead of " << corner->z << "; ";
          // At a cliff thinner than rounding a face keeps its own height.
          const auto vertex = own.find(key(p));
          const bool exact = vertices && vertex != own.end() && vertex->second.second && !overlay_.per_corner[m];
          if (exact) {
            if (z != vertex->second.first)
              wrong_ << "height " << z << " at vertex " << p.x << " " << p.y << " of input " << m << " instead of "
                     << vertex->second.first << "; ";
          } else if (!judge.allows(p, radius, z, parent)) {
            HeightJudge::Range range = judge.range(p, radius);
            // A corner may spill from all of the input.
            if (!range.found) range = judge.range(p, radius + report.max_move);
            if (range.found && range.low <= z && z <= range.high) continue;
            wrong_ << "height " << z << " at " << p.x << " " << p.y << " of input " << m << " is not in " << range.low
                   << " to " << range.high << "; ";
          }
        }
      }
    }
  }

  std::array<const Tin*, 2> inputs_;
  OverlayOptions options_;
  const Overlay& overlay_;
  std::array<PlanMesh, 2> meshes_;
  std::array<Places, 2> places_;
  std::ostringstream wrong_;
};

/// Which of several each of a row of choices took, where how many there are depends on those before. All take the first
/// to begin with; next() goes on to ways in which one does not, then two, and so on, and returns false after the last.
class Ways {
 public:
  std::size_t choose(std::size_t of) {
    if (at_ == chosen_.size()) chosen_.push_back({0, of});
    chosen_[at_].of = of;
    return chosen_[at_++].one;
  }
  bool next() {
    chosen_.resize(at_);
    at_ = 0;
    std::size_t others = this->others();
    if (others == allowed_) more_ = more_ || std::any_of(chosen_.begin(), chosen_.end(), Choice::could_be_other);
    for (; !chosen_.empty(); chosen_.pop_back()) {
      Choice& last = chosen_.back();
      if (last.one + 1 < last.of && (last.one > 0 || others < allowed_)) {
        ++last.one;
        return true;
      }
      others -= last.one > 0;
    }
    ++allowed_;
    return std::exchange(more_, false);
  }
  /// Ways with fewer others come by again on the way to those with more.
  bool was_seen() const { return others() < allowed_; }

 private:
  struct Choice {
    std::size_t one, of;
    static bool could_be_other(const Choice& c) { return c.one == 0 && c.of > 1; }
  };
  std::size_t others() const {
    return static_cast<std::size_t>(
        std::count_if(chosen_.begin(), chosen_.end(), [](const Choice& c) { return c.one > 0; }));
  }

  std::vector<Choice> chosen_;
  std::size_t at_ = 0;
  std::size_t allowed_ = 0;  // so many do not take the first
  bool more_ = false;        // could be
};

/// B with vertices on those of A that they may have been snapped to: within max_snap, no vertex of B. In the first of
/// the ways all go to the nearest that are missing from the result. Others may have been as well, where a crossing now
/// lies, and missing ones may be lost instead.
struct Guess {
  Tin b;
  std::size_t snapped = 0;  // places
  bool positive() const {   // snapping leaves all faces so
    return std::all_of(b.faces.begin(), b.faces.end(), [&](const Face& f) {
      return is_wall(b, f) || turn(plan(b.vertices[f[0]]), plan(b.vertices[f[1]]), plan(b.vertices[f[2]])) > 0;
    });
  }
};
Guess snapped_to(Ways& ways, const Tin& a, const Tin& b, const Overlay& overlay) {
  const Places there(overlay.points), of_b(plan_mesh(b).points);
  std::map<Place, Place> target;
  const auto is_taken = [&](Point2 q) {
    return of_b.contains(q) ||
           std::any_of(target.begin(), target.end(), [&](const auto& moved) { return moved.second == key(q); });
  };
  const PlanMesh mesh = plan_mesh(a);
  Guess guess{b};
  for (Point& p : guess.b.vertices) {
    const Place from{p.x, p.y};
    if (!target.contains(from)) {
      std::vector<std::pair<double, Place>> near;
      for (const Point2 q : mesh.points)
        if (const double d = std::hypot(q.x - p.x, q.y - p.y);
            d <= overlay.rounding.max_snap * (1 + 1e-15) && !is_taken(q))
          near.emplace_back(d, key(q));
      std::sort(near.begin(), near.end());
      near.insert(there.contains(plan(p)) ? near.begin() : near.end(), {0, from});
      target[from] = near[ways.choose(near.size())].second;
      guess.snapped += target[from] != from;
    }
    std::tie(p.x, p.y) = target[from];
  }
  return guess;
}

}  // namespace

Tin as_snapped(const Tin& a, const Tin& b, const Overlay& overlay) {
  Ways nearest;
  return overlay.rounding.snapped == 0 ? b : snapped_to(nearest, a, b, overlay).b;
}

std::string broken_promises(const Tin& a, const Tin& b, const OverlayOptions& options, const Overlay& overlay) {
  const std::string wrong = wrong_in_plan(overlay.points, overlay.faces);
  if (!wrong.empty()) return wrong;
  if (overlay.rounding.snapped == 0)
    return Judge(a, b, options, overlay).judged() + wrong_cover(a, b, options.refinement, overlay);
  // Which vertices were snapped to which is not reported: one of the ways must explain all.
  std::string first = "no way to snap as many vertices as reported leaves all faces positive; ";
  Ways ways;
  int judged = 0;
  for (int n = 0; n < 100'000 && judged < 256; ++n) {
    const Guess guess = snapped_to(ways, a, b, overlay);
    if (!ways.was_seen() && guess.snapped == static_cast<std::size_t>(overlay.rounding.snapped) && guess.positive()) {
      const std::string broken =
          Judge(a, guess.b, options, overlay).judged() + wrong_cover(a, guess.b, options.refinement, overlay);
      if (broken.empty()) return {};
      if (judged++ == 0) first = broken;
    }
    if (!ways.next()) break;
  }
  return first;
}

}  // namespace terrane::support
