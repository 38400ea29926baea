// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/surface/grid_heights.hpp"

#include <algorithm>
#include <cmath>

#include "core/corner_heights.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

/// Heights of a TIN at places that became fewer.
class Heights {
 public:
  Heights(const Tin& tin, const CompletedMesh& mesh, const std::vector<Index>& merged_into)
      : tin_(tin), mesh_(mesh), merged_into_(merged_into), first_(mesh.places.size() + 1, 0) {
    const auto each = [&](auto&& visit) {
      for (Index f = 0; f < mesh.real_faces; ++f)
        for (int k = 0; k < 3; ++k) visit(mesh.corner(4 * f + k), z(f, k));
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
      if (merged_into_[mesh_.corner(4 * face + k)] == place) return nearest(place, z(face, k));
    const Index* c = mesh_.links[face].corner;
    return nearest(place, height_on_triangle({mesh_.at(c[0]), mesh_.at(c[1]), mesh_.at(c[2])},
                                             {z(face, 0), z(face, 1), z(face, 2)}, p));
  }

 private:
  double z(Index face, int k) const { return tin_.vertices[tin_.faces[mesh_.tin_face(face)][k]].z; }

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

/// Every change leaves a place with a height less, so this ends.
class Reconciler {
 public:
  Reconciler(CornerSurface& surface, const Array<Face>& neighbours, bool walls)
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
  const Array<Face>& neighbours_;
  const CornersByPlace places_;
  const bool walls_;
  std::vector<double> heights_;
  std::vector<std::pair<double, double>> spans_;
};

}  // namespace

CornerSurface with_heights_of(const Tin& tin, const CompletedMesh& completed, PlanarMesh mesh,
                              const std::vector<Index>& merged_into) {
  const Heights heights(tin, completed, merged_into);
  CornerSurface surface;
  surface.points = std::move(mesh.points);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.faces[f][0] == none || mesh.labels[f] == none) continue;
    surface.faces.push_back(mesh.faces[f]);
    for (Index v : mesh.faces[f]) surface.z.push_back(heights.height(mesh.labels[f], v, surface.points[v]));
  }
  return surface;
}

void reconcile_heights(CornerSurface& surface, const Array<Face>& neighbours, bool walls) {
  Reconciler(surface, neighbours, walls).run();
}

}  // namespace terrane
