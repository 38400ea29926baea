// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay.hpp"

#include <algorithm>
#include <cmath>

#include "core/arrangement.hpp"
#include "core/heights.hpp"
#include "core/overlay_faces.hpp"
#include "core/predicates.hpp"
#include "core/rounding.hpp"
#include "core/snapping.hpp"

namespace terrane {
namespace {

Box frame_around(const Tin& a, const Tin& b) {
  Box box = bounds(a);
  const Box other = bounds(b);
  box = {std::min(box.xmin, other.xmin), std::min(box.ymin, other.ymin), std::max(box.xmax, other.xmax),
         std::max(box.ymax, other.ymax)};
  const double margin = 1 + (box.xmax - box.xmin) + (box.ymax - box.ymin);
  return {box.xmin - margin, box.ymin - margin, box.xmax + margin, box.ymax + margin};
}

bool all_positive(const OverlayFaces& work) {
  return std::all_of(work.faces.begin(), work.faces.end(), [&](const Face& f) {
    return orientation(work.points[f[0]], work.points[f[1]], work.points[f[2]]) > 0;
  });
}

/// Makes every face positive on its doubles.
void round_faces(const Arrangement& arrangement, OverlayFaces& work, const SurfaceHeights (&heights)[2],
                 RoundingReport& report, Context& context, std::vector<Index>& relabelled) {
  PlanarMesh mesh{std::move(work.points), std::move(work.faces), {}, std::move(work.region_of_face)};
  connect(mesh);
  const auto place = [&](Index v) {
    return v < arrangement.first_crossing() ? ExactPlace{} : crossing_place(arrangement, v);
  };
  const auto distance = [&](Index region, Point2 p) {
    double d = 0;
    for (int m = 0; m < 2; ++m)
      if (const Index f = work.regions[region][m]; f != none) d = std::max(d, heights[m].distance(f, p));
    return d;
  };
  const Rounded rounded = round_and_verify(mesh, place, context, distance);
  report.max_spill = rounded.report.max_spill;
  report.merges = rounded.report.merges;
  report.flips = rounded.report.flips;
  report.kinetic = rounded.report.kinetic;
  work.points = std::move(mesh.points);
  std::vector<Index> renumbered(mesh.faces.size(), none);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.faces[f][0] == none) continue;
    renumbered[f] = static_cast<Index>(work.faces.size());
    work.faces.push_back(mesh.faces[f]);
    work.region_of_face.push_back(mesh.labels[f]);
  }
  for (Index f : rounded.relabelled) relabelled.push_back(renumbered[f]);
}

}  // namespace

Overlay overlay(const Tin& a, const Tin& b, const OverlayOptions& options, Context& context) {
  context.progress("overlay", 0);
  Overlay result;
  const Box frame = frame_around(a, b);
  const CompletedMesh mesh_a = complete(a, frame);
  Snapped snapped = complete_and_snap(b, frame, mesh_a, options.snap);
  const CompletedMesh& mesh_b = snapped.mesh;
  result.rounding.snapped = snapped.count;
  result.rounding.max_snap = snapped.max_move;
  Arrangement arrangement(mesh_a, mesh_b, std::move(snapped.location), context);
  OverlayFaces work = faces_of(arrangement, options.refinement, false, context);
  const SurfaceHeights heights[2] = {{a, arrangement, 0, work.points}, {b, arrangement, 1, work.points}};
  result.rounding.regions = work.region_count;

  std::vector<Index> relabelled;
  if (!all_positive(work)) {
    work = faces_of(arrangement, options.refinement, true, context);
    round_faces(arrangement, work, heights, result.rounding, context, relabelled);
  }
  context.progress("overlay", 0.9);

  // Only what has a surface is returned, its vertices renumbered in the order of the arrangement.
  std::vector<bool> live(work.regions.size(), false), changed(work.faces.size(), false);
  for (Index f : relabelled) changed[f] = true;
  std::vector<Index> number(work.points.size(), none), vertex;
  std::vector<Index> kept;
  for (std::size_t f = 0; f < work.faces.size(); ++f) {
    const std::array<Index, 2>& parent = work.regions[work.region_of_face[f]];
    live[work.region_of_face[f]] = true;
    if (parent[0] == none && parent[1] == none) continue;
    kept.push_back(static_cast<Index>(f));
    for (Index v : work.faces[f]) number[v] = 0;
  }
  for (std::size_t v = 0; v < number.size(); ++v)
    if (number[v] == 0) {
      number[v] = static_cast<Index>(vertex.size());
      vertex.push_back(static_cast<Index>(v));
      result.points.push_back(work.points[v]);
      if (static_cast<Index>(v) >= arrangement.first_crossing())
        result.rounding.max_move =
            std::max(result.rounding.max_move, rounding_bound(crossing_place(arrangement, static_cast<Index>(v))));
    }
  for (std::size_t r = 0; r < work.regions.size(); ++r)
    result.rounding.collapsed += !live[r] && (work.regions[r][0] != none || work.regions[r][1] != none);
  result.faces.reserve(kept.size());
  result.parents.reserve(kept.size());
  for (Index f : kept) {
    const Face& c = work.faces[f];
    result.faces.push_back({number[c[0]], number[c[1]], number[c[2]]});
    const std::array<Index, 2>& parent = work.regions[work.region_of_face[f]];
    result.parents.push_back({parent[0] == none ? none : mesh_a.face_in_tin[parent[0]],
                              parent[1] == none ? none : mesh_b.face_in_tin[parent[1]]});
  }
  for (int m = 0; m < 2; ++m) {
    result.per_corner[m] = arrangement.mesh(m).jumps;
    std::vector<double>& z = result.heights[m];
    if (!result.per_corner[m]) {
      z.resize(vertex.size());
      for (std::size_t i = 0; i < vertex.size(); ++i) z[i] = heights[m].at_vertex(vertex[i]);
    } else {
      z.assign(3 * kept.size(), 0);
    }
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const Index f = work.regions[work.region_of_face[kept[i]]][m];
      if (f == none || (!result.per_corner[m] && !changed[kept[i]])) continue;
      for (int k = 0; k < 3; ++k) {
        const Index v = work.faces[kept[i]][k];
        if (result.per_corner[m]) {
          z[3 * i + k] = heights[m].in_face(f, v);
        } else if (std::isnan(z[number[v]])) {
          z[number[v]] = heights[m].in_face(f, v);  // a flip brought a vertex of the outside into the domain
        }
      }
    }
  }
  context.progress("overlay", 1);
  return result;
}

}  // namespace terrane
