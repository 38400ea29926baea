// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/volume_areas.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/box.hpp"
#include "core/level_cuts.hpp"
#include "core/mosaic.hpp"
#include "core/plan/zone_polygons.hpp"
#include "core/predicates.hpp"
#include "core/rounding/rounding.hpp"
#include "core/sum.hpp"
#include "core/triangle_height.hpp"
#include "core/volume/area_weights.hpp"

namespace terrane {
namespace {

/// A surface and how far it lies above its reference, where both exist.
struct Difference {
  CornerSurface dz;
  std::vector<double> z;  // of the surface: 3 * face + corner
};

Difference difference(const Overlay& both) {
  Difference d;
  std::vector<Index> number(both.points.size(), none);
  for (Index f = 0; f < static_cast<Index>(both.faces.size()); ++f) {
    if (both.parents[f][0] == none || both.parents[f][1] == none) continue;
    Face face = both.faces[f];
    for (int k = 0; k < 3; ++k) {
      Index& v = number[face[k]];
      if (v == none) {
        v = static_cast<Index>(d.dz.points.size());
        d.dz.points.push_back(both.points[face[k]]);
      }
      face[k] = v;
      d.z.push_back(both.height(0, f, k));
      d.dz.z.push_back(both.height(0, f, k) - both.height(1, f, k));
    }
    d.dz.faces.push_back(face);
  }
  return d;
}

Difference difference(const Tin& surface, double level) {
  Difference d;
  d.dz = piece_of(surface, 0).surface;
  d.z = d.dz.z;
  for (double& z : d.dz.z) z -= level;
  d.dz.firm.clear();
  return d;
}

/// What one connected area amounts to.
struct Figures {
  VolumeKind kind = VolumeKind::same;
  Sum volume, area_2d, area_3d;
  double max_dz = 0;
};

class Areas {
 public:
  Areas(Difference difference, double tolerance, Context& context) : z_(std::move(difference.z)), context_(context) {
    std::vector<double> levels = {0};
    // What differs by the tolerance itself is the same.
    if (tolerance > 0) levels = {-tolerance, std::nextafter(tolerance, std::numeric_limits<double>::infinity())};
    pieces_ = level_pieces(std::move(difference.dz), levels, context);
    find_kinds(tolerance > 0);
    find_areas();
  }

  VolumeAreas measured(const AreaScale& scale, const Steepness& steepness) {
    measure(scale, steepness);
    pieces_.mesh.zone = std::move(area_of_face_);
    const ZonedMesh outlines = dissolve(pieces_.mesh, 4 * pieces_.rounding.max_move, context_);
    std::vector<std::vector<Polygon>> polygons = zone_polygons(outlines);
    VolumeAreas result;
    result.rounding = pieces_.rounding;
    for (std::size_t i = 0; i < figures_.size(); ++i) {
      const Figures& of = figures_[i];
      result.areas.push_back({of.kind, std::move(polygons[i].front()), of.volume.value(), of.area_2d.value(),
                              of.area_3d.value(), of.max_dz});
    }
    std::stable_sort(result.areas.begin(), result.areas.end(), [](const VolumeArea& a, const VolumeArea& b) {
      return a.kind != b.kind ? a.kind < b.kind : a.area_2d > b.area_2d;
    });
    return result;
  }

 private:
  double dz(Index parent, int k) const { return pieces_.surface.z[3 * static_cast<std::size_t>(parent) + k]; }

  void find_kinds(bool tolerant) {
    const ZonedMesh& mesh = pieces_.mesh;
    kinds_.resize(mesh.faces.size());
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      const Index parent = pieces_.parent[f], zone = mesh.zone[f];
      const bool level = dz(parent, 0) == 0 && dz(parent, 1) == 0 && dz(parent, 2) == 0;
      kinds_[f] = zone == 0  ? VolumeKind::below
                  : tolerant ? (zone == 1 ? VolumeKind::same : VolumeKind::above)
                  : level    ? VolumeKind::same
                             : VolumeKind::above;
    }
  }

  void find_areas() {
    const ZonedMesh& mesh = pieces_.mesh;
    PlanarMesh planar{mesh.points, mesh.faces, {}, {}};
    connect(planar);
    area_of_face_.assign(mesh.faces.size(), none);
    std::vector<Index> stack;
    for (Index seed = 0; seed < static_cast<Index>(mesh.faces.size()); ++seed) {
      if (area_of_face_[seed] != none) continue;
      const auto area = static_cast<Index>(figures_.size());
      figures_.emplace_back().kind = kinds_[seed];
      area_of_face_[seed] = area;
      stack.push_back(seed);
      while (!stack.empty()) {
        const Index f = stack.back();
        stack.pop_back();
        for (const Index g : planar.neighbours[f])
          if (g != none && area_of_face_[g] == none && kinds_[g] == kinds_[f])
            area_of_face_[g] = area, stack.push_back(g);
      }
    }
  }

  void measure(const AreaScale& scale, const Steepness& steepness) {
    const ZonedMesh& mesh = pieces_.mesh;
    Box box = no_box;
    for (const Point2 p : mesh.points) box = around(box, p);
    const AreaWeights weights(scale, box);
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      if (f % 65536 == 0) context_.progress("volume", static_cast<double>(f) / static_cast<double>(mesh.faces.size()));
      const std::array<Point2, 3> p = {mesh.points[mesh.faces[f][0]], mesh.points[mesh.faces[f][1]],
                                       mesh.points[mesh.faces[f][2]]};
      const auto w = weights(p, 0.5 * std::fabs(area2_accurate(p[0], p[1], p[2])));
      add(figures_[area_of_face_[f]], pieces_.parent[f], p, w, steepness);
    }
  }

  void add(Figures& to, Index parent, const std::array<Point2, 3>& p, const std::array<double, 3>& w,
           const Steepness& steepness) const {
    const Face& corners = pieces_.surface.faces[parent];
    const Point2 c[3] = {pieces_.surface.points[corners[0]], pieces_.surface.points[corners[1]],
                         pieces_.surface.points[corners[2]]};
    const double over[3] = {dz(parent, 0), dz(parent, 1), dz(parent, 2)};
    const std::size_t first = 3 * static_cast<std::size_t>(parent);
    const double sign = to.kind == VolumeKind::below ? -1 : 1;
    double volume = 0;
    for (int k = 0; k < 3; ++k) {
      const double height = height_on_triangle(c, over, p[k]);
      volume += w[k] * height;
      if (to.kind != VolumeKind::same) to.max_dz = std::max(to.max_dz, sign * height);
    }
    const double area = w[0] + w[1] + w[2];
    if (to.kind != VolumeKind::same) to.volume.add(sign * volume);
    to.area_2d.add(area);
    const double slope = steepness ? steepness({c[0].x, c[0].y, z_[first]}, {c[1].x, c[1].y, z_[first + 1]},
                                               {c[2].x, c[2].y, z_[first + 2]})
                                   : std::hypot(1, slope_of_triangle(c, {z_[first], z_[first + 1], z_[first + 2]}));
    to.area_3d.add(slope * area);
  }

  std::vector<double> z_;
  Context& context_;
  LevelPieces pieces_;
  std::vector<VolumeKind> kinds_;  // per face of the pieces
  std::vector<Index> area_of_face_;
  std::vector<Figures> figures_;
};

VolumeAreas measured(Difference difference, double tolerance, const AreaScale& scale, const Steepness& steepness,
                     Context& context) {
  if (difference.dz.faces.empty()) return {};
  return Areas(std::move(difference), tolerance, context).measured(scale, steepness);
}

}  // namespace

VolumeAreas volume_areas(const Tin& surface, const Tin& reference, double tolerance, const AreaScale& scale,
                         const Steepness& steepness, Context& context) {
  if (surface.faces.empty() || reference.faces.empty()) return {};
  const Overlay both = overlay(surface, reference, {}, context);
  VolumeAreas result = measured(difference(both), tolerance, scale, steepness, context);
  RoundingReport rounding = both.rounding;
  accumulate(rounding, result.rounding);
  result.rounding = rounding;
  return result;
}

VolumeAreas volume_areas(const Tin& surface, double level, double tolerance, const AreaScale& scale,
                         const Steepness& steepness, Context& context) {
  return measured(difference(surface, level), tolerance, scale, steepness, context);
}

}  // namespace terrane
