// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/plan_grid.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "core/completed.hpp"
#include "core/corner_heights.hpp"
#include "core/error.hpp"
#include "core/predicates.hpp"
#include "core/rounding.hpp"
#include "core/sum.hpp"
#include "core/triangle_height.hpp"
#include "core/walls.hpp"

namespace terrane {
namespace {

std::string shortest(double x) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, x).ptr};
}

double area_in_plan(const std::vector<Point2>& points, const std::vector<Face>& faces) {
  Sum area;
  for (const Face& f : faces) area.add(0.5 * area2_accurate(points[f[0]], points[f[1]], points[f[2]]));
  return area.value();
}

/// Heights of a TIN at places that became fewer.
class Heights {
 public:
  Heights(const Tin& tin, const CompletedMesh& mesh, const std::vector<Index>& merged_into)
      : tin_(tin), mesh_(mesh), merged_into_(merged_into), first_(mesh.places.size() + 1, 0) {
    const auto each = [&](auto&& visit) {
      for (Index f = 0; f < mesh.real_faces; ++f)
        for (int k = 0; k < 3; ++k) visit(mesh.corner[4 * f + k], z(f, k));
    };
    each([&](Index v, double) { ++first_[v + 1]; });
    for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
    heights_.resize(first_.back());
    last_.assign(first_.begin(), first_.end() - 1);
    each([&](Index v, double height) { heights_[last_[v]++] = height; });
    const Index places = static_cast<Index>(last_.size());
    for (Index v = 0; v < places; ++v) {
      const auto begin = heights_.begin() + first_[v], end = heights_.begin() + last_[v];
      std::sort(begin, end);
      last_[v] = std::unique(begin, end) - heights_.begin();
    }
    for (Index v = 0; v < places; ++v) leader_.push_back(v);
    for (Index v = 0; v < places; ++v)
      if (Index& leads = leader_[merged_into[v]]; count(v) > count(leads)) leads = v;
  }

  /// At a place, as a face of the TIN has it.
  double height(Index face, Index place, Point2 p) const {
    for (int k = 0; k < 3; ++k)
      if (merged_into_[mesh_.corner[4 * face + k]] == place) return nearest(place, z(face, k));
    const Index* c = &mesh_.corner[4 * face];
    return nearest(place, height_on_triangle({mesh_.at(c[0]), mesh_.at(c[1]), mesh_.at(c[2])},
                                             {z(face, 0), z(face, 1), z(face, 2)}, p));
  }

 private:
  double z(Index face, int k) const { return tin_.vertices[mesh_.vertex[3 * face + k]].z; }

  std::size_t count(Index place) const { return last_[place] - first_[place]; }

  double nearest(Index place, double z) const {
    const double *low = &heights_[first_[leader_[place]]], *high = &heights_[0] + last_[leader_[place]];
    const double* above = std::lower_bound(low, high, z);
    if (above == high) return *(high - 1);
    if (above == low) return *above;
    return z - *(above - 1) <= *above - z ? *(above - 1) : *above;
  }

  const Tin& tin_;
  const CompletedMesh& mesh_;
  const std::vector<Index>& merged_into_;
  std::vector<std::size_t> first_, last_;  // of a place: its heights, ascending
  std::vector<double> heights_;
  std::vector<Index> leader_;  // of the places that became one: whose heights it has
};

/// Merges can leave heights at a place that no longer make a surface with walls: a jump that changes its sign along an
/// edge, or two heights that no jump along an edge joins. Such heights become one. Every time a place has a height less,
/// so this ends.
class Reconciler {
 public:
  Reconciler(CornerSurface& surface, const std::vector<Face>& neighbours, bool walls)
      : surface_(surface),
        neighbours_(neighbours),
        places_(corners_by_place(surface.faces, surface.points.size())),
        walls_(walls) {}

  void run() {
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t f = 0; f < surface_.faces.size(); ++f)
        for (int k = 0; k < 3; ++k)
          if (neighbours_[f][k] > static_cast<Index>(f)) changed = uncross(f, k) || changed;
      for (std::size_t v = 0; v < surface_.points.size(); ++v) changed = join(v) || changed;
    }
  }

 private:
  struct Pair {
    Index place;
    double here, there;  // the heights of a face and of the face across an edge
    double jump() const { return here - there; }
  };
  /// At the end of the edge opposite corner k of face f that is its corner `end`.
  Pair heights(std::size_t f, int k, int end) const {
    const Index place = surface_.faces[f][end], g = neighbours_[f][k];
    const Face& across = surface_.faces[g];
    const auto at = std::find(across.begin(), across.end(), place) - across.begin();
    return {place, surface_.z[3 * f + end], surface_.z[3 * static_cast<std::size_t>(g) + at]};
  }

  /// Both sides take the lower height at the end where they differ less.
  bool uncross(std::size_t f, int k) {
    const Pair p = heights(f, k, (k + 1) % 3), q = heights(f, k, (k + 2) % 3);
    if (!((p.jump() < 0 && q.jump() > 0) || (p.jump() > 0 && q.jump() < 0))) return false;
    const Pair& less = std::fabs(p.jump()) <= std::fabs(q.jump()) ? p : q;
    const double low = std::min(less.here, less.there), high = std::max(less.here, less.there);
    replace(less.place, low, high, low);
    return true;
  }

  void replace(Index place, double above, double up_to, double with) {
    for (std::size_t i = places_.first[place]; i < places_.first[place + 1]; ++i)
      if (double& z = surface_.z[places_.corners[i]]; z > above && z <= up_to) z = with;
  }

  /// Jumps join the heights they span; of two neighbouring heights that none joins the upper becomes the lower.
  bool join(std::size_t place) {
    heights_.clear();
    const std::size_t first = places_.first[place], last = places_.first[place + 1];
    for (std::size_t i = first; i < last; ++i) heights_.push_back(surface_.z[places_.corners[i]]);
    std::sort(heights_.begin(), heights_.end());
    heights_.erase(std::unique(heights_.begin(), heights_.end()), heights_.end());
    if (heights_.size() < 2) return false;
    spans_.clear();
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t f = places_.corners[i] / 3;
      const int corner = static_cast<int>(places_.corners[i] % 3);
      for (const int step : {1, 2}) {  // the edges from this corner to the two others
        const int k = (corner + step) % 3, other = (corner + 3 - step) % 3;
        if (neighbours_[f][k] == none) continue;
        const Pair p = heights(f, k, corner);
        if (p.jump() < 0 && (walls_ || heights(f, k, other).jump() != 0)) spans_.emplace_back(p.here, p.there);
        if (p.jump() > 0 && (walls_ || heights(f, k, other).jump() != 0)) spans_.emplace_back(p.there, p.here);
      }
    }
    for (std::size_t i = 1; i < heights_.size(); ++i) {
      const double low = heights_[i - 1], high = heights_[i];
      if (std::any_of(spans_.begin(), spans_.end(), [&](auto& s) { return s.first <= low && s.second >= high; }))
        continue;
      replace(static_cast<Index>(place), low, high, low);
      return true;
    }
    return false;
  }

  CornerSurface& surface_;
  const std::vector<Face>& neighbours_;
  const CornersByPlace places_;
  const bool walls_;
  std::vector<double> heights_;
  std::vector<std::pair<double, double>> spans_;
};

Box frame_around(const Tin& tin) {
  const Box box = bounds(tin);
  const double margin = 1 + (box.xmax - box.xmin) + (box.ymax - box.ymin);
  return {box.xmin - margin, box.ymin - margin, box.xmax + margin, box.ymax + margin};
}

double distance_to_face(const CompletedMesh& mesh, Index face, Point2 p) {
  bool inside = true;
  double least = INFINITY;
  for (int k = 0; k < 3; ++k) {
    const Point2 a = mesh.at(mesh.corner[4 * face + k]), b = mesh.at(mesh.corner[4 * face + (k + 1) % 3]);
    inside = inside && orientation(a, b, p) >= 0;
    double d;
    nearest_on_segment(a, b, p, d);
    least = std::min(least, d);
  }
  return inside ? 0 : least;
}

}  // namespace

PlanGrid::PlanGrid(double step) : step_(step), numerator_(step), denominator_(1) {
  double power = 1;
  for (int digits = 0; digits <= 22; ++digits, power *= 10) {
    const double whole = std::nearbyint(step * power);
    if (whole < 1 || whole > 1e15 || whole / power != step) continue;
    numerator_ = whole, denominator_ = power;
    return;
  }
}

double PlanGrid::nearest(double x) const {
  const double count = std::nearbyint(x * denominator_ / numerator_);
  if (!(std::fabs(count * numerator_) < 0x1p53)) return x;
  return count * numerator_ / denominator_ + 0.0;  // no negative zero
}

OnGrid put_on_grid(const Tin& tin, const PlanGrid& grid, Context& context) {
  OnGrid result;
  if (tin.faces.empty()) {
    result.tin = tin;
    return result;
  }
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorKind::input, "grid", "on a grid of " + shortest(grid.step()) + " " + why + "; use a finer grid");
  };
  const Box box = bounds(tin);
  if (grid.step() > (box.xmax - box.xmin) + (box.ymax - box.ymin)) refuse("no face is left of the surface");
  context.progress("grid", 0);
  const CompletedMesh completed = complete(tin, frame_around(tin));
  const Index moving = completed.real_places();
  PlanarMesh mesh;
  mesh.points = completed.places;
  for (Index v = 0; v < moving; ++v) mesh.points[v] = grid.nearest(completed.at(v));
  std::vector<Face> before;
  for (Index f = 0; f < completed.faces(); ++f) {
    mesh.faces.push_back({completed.corner[4 * f], completed.corner[4 * f + 1], completed.corner[4 * f + 2]});
    mesh.labels.push_back(completed.real(f) ? f : none);
    if (completed.real(f)) before.push_back(mesh.faces.back());
  }
  connect(mesh);
  const auto place = [&](Index v) {
    ExactPlace at;
    if (v < moving) at.kind = ExactPlace::lattice, at.p = completed.at(v);
    return at;
  };
  const auto distance = [&](Index label, Point2 p) { return label == none ? 0 : distance_to_face(completed, label, p); };
  Rounded rounded;
  try {
    rounded = round_and_verify(mesh, place, context, distance);
  } catch (const Error& error) {
    if (error.kind != ErrorKind::input) throw;
    refuse(std::string("the surface cannot be kept valid: ") + error.what());
  }
  context.progress("grid", 0.7);

  const Heights heights(tin, completed, rounded.merged_into);
  CornerSurface surface;
  surface.points = std::move(mesh.points);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.faces[f][0] == none || mesh.labels[f] == none) continue;
    surface.faces.push_back(mesh.faces[f]);
    for (Index v : mesh.faces[f]) surface.z.push_back(heights.height(mesh.labels[f], v, surface.points[v]));
  }
  if (surface.faces.empty()) refuse("no face is left of the surface");
  result.area_lost = area_in_plan(completed.places, before) - area_in_plan(surface.points, surface.faces);
  mesh = {surface.points, surface.faces, {}, {}};
  connect(mesh);
  const bool walls = std::any_of(tin.faces.begin(), tin.faces.end(), [&](const Face& f) { return is_wall(tin, f); });
  Reconciler(surface, mesh.neighbours, walls).run();
  result.tin = canonical(raise(surface, mesh.neighbours, walls).tin);
  result.rounding = rounded.report;
  context.progress("grid", 1);
  return result;
}

}  // namespace terrane
