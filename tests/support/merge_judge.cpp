// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/merge_judge.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <tuple>

#include "support/checks.hpp"
#include "support/height_judge.hpp"
#include "support/plan_mesh.hpp"

namespace terrane::support {
namespace {

using Real = long double;

struct Edge {
  Point2 p, q;
  std::size_t tile;
};

std::vector<Edge> borders(const std::vector<Tin>& tiles) {
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const PlanMesh mesh = plan_mesh(tiles[i]);
    for (const auto& [u, v] : border_of(mesh.faces)) edges.push_back({mesh.points[u], mesh.points[v], i});
  }
  return edges;
}

Real x_at(const Edge& e, Real y, Real x0, Real y0) {
  const Real px = e.p.x - x0, py = e.p.y - y0, qx = e.q.x - x0, qy = e.q.y - y0;
  return px + (qx - px) * ((y - py) / (qy - py));
}

/// The heights that a policy may make of ranges of heights, one per tile that takes part.
struct Range {
  double low, high;
};
Range folded(Overlap policy, std::vector<Range> z) {
  if (policy == Overlap::first) return z.front();
  if (policy == Overlap::last) return z.back();
  if (policy == Overlap::mean || policy == Overlap::sum) {
    Range sum{0, 0};
    for (const Range& r : z) sum = {sum.low + r.low, sum.high + r.high};
    const double n = policy == Overlap::mean ? static_cast<double>(z.size()) : 1;
    return {sum.low / n, sum.high / n};
  }
  if (policy == Overlap::median) {
    std::vector<double> low, high;
    for (const Range& r : z) low.push_back(r.low), high.push_back(r.high);
    std::sort(low.begin(), low.end());
    std::sort(high.begin(), high.end());
    const std::size_t i = (z.size() - 1) / 2, j = z.size() / 2;
    return {(low[i] + low[j]) / 2, (high[i] + high[j]) / 2};
  }
  // Where ranges meet the surfaces may cross, and the crossing has the height of either.
  const bool lowest = policy == Overlap::min;
  std::sort(z.begin(), z.end(),
            [&](const Range& r, const Range& s) { return lowest ? r.low < s.low : r.high > s.high; });
  Range all = z.front();
  for (const Range& r : z)
    if (r.low <= all.high && r.high >= all.low) all = {std::min(all.low, r.low), std::max(all.high, r.high)};
  return all;
}

class Judge {
 public:
  Judge(const std::vector<Tin>& tiles, const MergeOptions& options, const Merged& merged)
      : tiles_(tiles),
        options_(options),
        tin_(merged.surface.tin),
        report_(merged.surface.rounding),
        steps_(static_cast<double>(tiles.size())),
        borders_(borders(tiles)) {
    wrong_.precision(17);
  }

  std::string judged() {
    wrong_ << wrong_with_surface(tin_, options_.assembly.seam == Seam::split);
    judge_area();
    judge_presence();
    judge_heights();
    return wrong_.str();
  }

 private:
  /// A place may be moved once by every overlay it takes part in.
  double reach() const { return steps_ * (3 * report_.max_move + report_.max_snap); }

  void judge_area() {
    Real found = 0, border = 0, extent = 0;
    for (const Face& f : tin_.faces) {
      const Point &a = tin_.vertices[f[0]], &b = tin_.vertices[f[1]], &c = tin_.vertices[f[2]];
      found += ((Real(b.x) - a.x) * (Real(c.y) - a.y) - (Real(b.y) - a.y) * (Real(c.x) - a.x)) / 2;
    }
    for (const Edge& e : borders_) border += std::hypot(Real(e.p.x) - e.q.x, Real(e.p.y) - e.q.y);
    const Box box = bounds(tin_);
    extent = box.xmax - box.xmin + box.ymax - box.ymin;
    const Real wanted = union_area(tiles_), allowed = reach() * border + 1e-15L * extent * extent;
    if (!(std::fabs(found - wanted) <= allowed))
      wrong_ << "the area is " << found << " instead of " << wanted << ", off by more than " << allowed << "; ";
  }

  void judge_presence() {
    std::set<std::pair<double, double>> there;
    for (const Point& p : tin_.vertices) there.emplace(p.x, p.y);
    const bool paste = options_.overlap == Overlap::first || options_.overlap == Overlap::last;
    std::set<std::pair<double, double>> missing;
    for (std::size_t i = 0; i < tiles_.size(); ++i) {
      const std::size_t on_top = options_.overlap == Overlap::first ? 0 : tiles_.size() - 1;
      if (paste && i != on_top) continue;  // others lie under it
      const PlanMesh mesh = plan_mesh(tiles_[i]);
      for (const Point2 p : mesh.points)
        if (!there.contains({p.x, p.y})) missing.emplace(p.x, p.y);
    }
    const std::size_t reported = static_cast<std::size_t>(report_.snapped) + static_cast<std::size_t>(report_.lost);
    if (missing.size() > reported)
      wrong_ << missing.size() << " vertices of the tiles are gone, " << reported << " were snapped or lost; ";
  }

  void judge_heights() {
    std::vector<HeightJudge> judges;
    for (const Tin& tile : tiles_) judges.emplace_back(tile);
    const double radius = 2 * reach();
    for (const Point& p : tin_.vertices) {
      std::vector<Range> z;
      std::vector<bool> may_be_out;
      double largest = 0;
      for (const HeightJudge& judge : judges) {
        const HeightJudge::Range r = judge.range(plan(p), radius);
        if (!r.found) continue;
        z.push_back({r.low, r.high});
        may_be_out.push_back(judge.at_border(plan(p), radius));
        largest = std::max(largest, judge.largest(plan(p), radius));
      }
      // Welding closes jumps of up to 1e-9 of the height at a corner, and tilts the face; every fold rounds.
      const double slack = steps_ * (1e-9 * std::max(1.0, largest) + 1e-15 * steps_ * largest);
      bool right = false;
      for (unsigned out = 0; out < 1u << z.size() && !right; ++out) {
        std::vector<Range> taking_part;
        bool possible = true;
        for (std::size_t i = 0; i < z.size(); ++i) {
          const bool is_out = out >> i & 1;
          possible = possible && (!is_out || may_be_out[i]);
          if (!is_out) taking_part.push_back(z[i]);
        }
        if (!possible || taking_part.empty()) continue;
        const Range r = folded(options_.overlap, taking_part);
        right = p.z >= r.low - slack && p.z <= r.high + slack;
      }
      if (!right) wrong_ << "height " << p.z << " at " << p.x << " " << p.y << " is none that the tiles make; ";
    }
  }

  const std::vector<Tin>& tiles_;
  const MergeOptions& options_;
  const Tin& tin_;
  const RoundingReport& report_;
  double steps_;
  std::vector<Edge> borders_;
  std::ostringstream wrong_;
};

}  // namespace

std::string wrong_with_surface(const Tin& tin, bool split) {
  std::ostringstream wrong;
  wrong.precision(17);
  const PlanMesh mesh = plan_mesh(tin);
  // Vertices of walls alone are places too.
  std::vector<bool> used(mesh.points.size(), false);
  for (const Face& f : mesh.faces)
    for (const Index v : f) used[v] = true;
  if (std::find(used.begin(), used.end(), false) != used.end()) wrong << "a wall stands away from the surface; ";
  wrong << wrong_in_plan(mesh.points, mesh.faces);
  std::set<std::tuple<double, double, double>> places;
  for (const Point& p : tin.vertices)
    if (!places.emplace(p.x, p.y, p.z).second) wrong << "two vertices at " << p.x << " " << p.y << " " << p.z << "; ";
  if (!split) wrong << open_seams(tin);
  return wrong.str();
}

double union_area(const std::vector<Tin>& tiles) {
  const std::vector<Edge> edges = borders(tiles);
  if (edges.empty()) return 0;
  const Real x0 = edges[0].p.x, y0 = edges[0].p.y;
  std::vector<Real> stops;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    stops.push_back(edges[i].p.y - y0);
    for (std::size_t j = i + 1; j < edges.size(); ++j) {
      const Edge &s = edges[i], &t = edges[j];
      if (s.tile == t.tile) continue;
      const Real ux = Real(s.q.x) - s.p.x, uy = Real(s.q.y) - s.p.y, vx = Real(t.q.x) - t.p.x, vy = Real(t.q.y) - t.p.y;
      const Real across = ux * vy - uy * vx, at = ((t.p.x - Real(s.p.x)) * vy - (t.p.y - Real(s.p.y)) * vx) / across;
      if (at > 0 && at < 1) stops.push_back(s.p.y - y0 + at * uy);
    }
  }
  std::sort(stops.begin(), stops.end());
  // Between two stops the union's width is linear in y.
  Real area = 0;
  std::vector<std::pair<std::size_t, Real>> crossings;
  std::vector<std::pair<Real, Real>> spans;
  for (std::size_t s = 0; s + 1 < stops.size(); ++s) {
    const Real height = stops[s + 1] - stops[s], y = stops[s] + height / 2;
    if (height <= 0) continue;
    crossings.clear(), spans.clear();
    for (const Edge& e : edges)
      if ((e.p.y - y0 <= y) != (e.q.y - y0 <= y)) crossings.emplace_back(e.tile, x_at(e, y, x0, y0));
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
      spans.emplace_back(crossings[i].second, crossings[i + 1].second);
    std::sort(spans.begin(), spans.end());
    Real width = 0, reached = -INFINITY;
    for (const auto& [low, high] : spans) {
      if (high > reached) width += high - std::max(low, reached);
      reached = std::max(reached, high);
    }
    area += width * height;
  }
  return static_cast<double>(area);
}

std::string broken_promises(const std::vector<Tin>& tiles, const MergeOptions& options, const Merged& merged) {
  return Judge(tiles, options, merged).judged();
}

}  // namespace terrane::support
