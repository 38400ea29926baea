// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

#include "core/box.hpp"
#include "core/error.hpp"
#include "core/overlay/arrangement.hpp"
#include "core/overlay/depth.hpp"
#include "core/overlay/heights.hpp"
#include "core/overlay/mended_heights.hpp"
#include "core/overlay/overlay_faces.hpp"
#include "core/overlay/shared_faces.hpp"
#include "core/overlay/snapping.hpp"
#include "core/parallel.hpp"
#include "core/plan/segment_index.hpp"
#include "core/rounding/rounding.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

/// Completes A and B and snaps B's vertices to A's, the two completions side by side.
struct Prepared {
  CompletedMesh a;
  Snapped b;
};
Prepared prepare(const Tin& a, const Tin& b, double snap, Context& context) {
  const Box frame = frame_around(around(bounds(a), bounds(b)));
  CompletedMesh completed[2];
  parallel_tasks(context, 2, [&](std::size_t m) { completed[m] = complete(m == 0 ? a : b, frame); });
  Snapped snapped = snap_places(b, frame, std::move(completed[1]), completed[0], snap, context);
  return {std::move(completed[0]), std::move(snapped)};
}

/// Which region is at home at a place, for those that stand for the outside of an input.
class HomeRegions {
 public:
  HomeRegions(const Arrangement& arrangement, const Array<std::array<Index, 2>>& regions, Refinement refinement)
      : arrangement_(arrangement),
        regions_(regions),
        pasted_(refinement == Refinement::paste),
        outline_(refinement == Refinement::outline) {}

  /// `region`, unless an input that it leaves out has a face around p: then the region of the faces that p lies in.
  Index operator()(Index region, Point2 p) {
    const std::array<Index, 2> own = region == none ? std::array{none, none} : regions_[region];
    if (own[0] != none && (own[1] != none || pasted_)) return region;  // B goes on under a pasted A
    std::array<Index, 2> home = own;
    for (int m = 0; m < 2; ++m) {
      const CompletedMesh& mesh = *arrangement_.mesh[m];
      const Location where = locate(mesh, p, last_[m]);
      last_[m] = face_at(mesh, where);
      if (where.kind == Location::face && mesh.real(where.index)) home[m] = m == 1 && outline_ ? 0 : where.index;
    }
    if ((own[0] == none) == (home[0] == none) && (own[1] == none) == (home[1] == none)) return region;
    if (pasted_ && home[0] != none) home[1] = none;
    return numbered(home, region);
  }

 private:
  /// The number of the region with these parents, `otherwise` when there is none.
  Index numbered(const std::array<Index, 2>& parents, Index otherwise) {
    if (sorted_.empty()) {
      sorted_.resize(regions_.size());
      std::iota(sorted_.begin(), sorted_.end(), 0);
      std::sort(sorted_.begin(), sorted_.end(), [&](Index r, Index s) { return regions_[r] < regions_[s]; });
    }
    const auto found = std::lower_bound(sorted_.begin(), sorted_.end(), parents,
                                        [&](Index r, const auto& wanted) { return regions_[r] < wanted; });
    return found != sorted_.end() && regions_[*found] == parents ? *found : otherwise;
  }

  const Arrangement& arrangement_;
  const Array<std::array<Index, 2>>& regions_;
  bool pasted_, outline_;
  Index last_[2] = {0, 0};     // the faces around the last place, where the next one is looked for first
  std::vector<Index> sorted_;  // by their parents; made when first needed
};

/// How far places lie from a mesh that is one area: 0 inside.
class DistanceToArea {
 public:
  explicit DistanceToArea(const CompletedMesh& mesh) : mesh_(mesh) {}

  double operator()(Point2 p) {
    last_ = face_at(mesh_, locate(mesh_, p, last_));
    if (mesh_.real(last_)) return 0;
    if (!border_) border_.emplace(border_of(mesh_), 0);
    // What the nearest found within a box may be beaten by lies in a box as far out as that.
    for (double reach = border_->cell_size();; reach *= 2) {
      border_->near({p.x - reach, p.y - reach, p.x + reach, p.y + reach}, found_);
      double least = std::numeric_limits<double>::infinity();
      for (const Index i : found_) {
        double d;
        nearest_on_segment((*border_)[i][0], (*border_)[i][1], p, d);
        least = std::min(least, d);
      }
      if (least <= reach || found_.size() == border_->size()) return least;
    }
  }

 private:
  static std::vector<std::array<Point2, 2>> border_of(const CompletedMesh& mesh) {
    std::vector<std::array<Point2, 2>> border;
    for (Index e = 0; e < mesh.edges(); ++e)
      if (const Index h = mesh.half[e]; mesh.sides[e] == 1 && mesh.twin(h) != none)
        border.push_back({mesh.at(mesh.origin(h)), mesh.at(mesh.target(h))});
    return border;
  }

  const CompletedMesh& mesh_;
  Index last_ = 0;                      // the face around the last place
  std::optional<SegmentIndex> border_;  // made when first needed
  std::vector<Index> found_;
};

/// Makes every face positive on its doubles. Faces keep their parents' order no longer; `relabelled` lists those whose
/// corners or parents changed.
void mend(const Arrangement& arrangement, OverlayFaces& work, Array<Point2>& points, const FaceHeights (&heights)[2],
          Refinement refinement, RoundingReport& report, Context& context, std::vector<Index>& relabelled) {
  Array<std::array<Index, 2>> regions;  // faces of a region are consecutive
  PlanarMesh mesh{std::move(points), std::move(work.faces), {}, {}};
  mesh.labels.resize(mesh.faces.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (f == 0 || work.parents[f] != work.parents[f - 1]) regions.push_back(work.parents[f]);
    const bool outside = work.parents[f][0] == none && work.parents[f][1] == none;
    mesh.labels[f] = outside ? none : static_cast<Index>(regions.size()) - 1;
  }
  connect(mesh);
  // What lies outside a mesh, the exterior outside both, must not reach into it either; but A may lie on B.
  const double reach = 16 * report.max_move, enough = 3 * report.max_move;
  Depth depth[2] = {{*arrangement.mesh[0], reach, enough}, {*arrangement.mesh[1], reach, enough}};
  DistanceToArea area(*arrangement.mesh[1]);
  const auto spill = [&](Index region, std::span<const Point2> corners) {
    double d = 0;
    for (int m = 0; m < 2; ++m) {
      const Index f = region == none ? none : regions[region][m];
      if (f != none) {
        for (const Point2 p : corners)
          d = std::max(d, m == 1 && refinement == Refinement::outline ? area(p) : heights[m].distance(f, p));
      } else if (m == 0 || region == none || refinement != Refinement::paste) {
        d = std::max(d, depth[m].of(corners));
      }
    }
    return d;
  };
  HomeRegions at_home(arrangement, regions, refinement);
  const Rounded rounded = round_and_verify(
      mesh, [&](Index v) { return exact_place(arrangement, v); }, context, spill, std::ref(at_home));
  report.max_move = std::max(report.max_move, rounded.report.max_move);
  if (rounded.report.max_spill > 3 * report.max_move)
    throw Error(
        ErrorKind::input, "rounding",
        "the surfaces come closer to each other than doubles can tell apart, and a face cannot be kept within "
        "three roundings of where it belongs; snap their vertices together or use coordinates nearer the origin");
  // What rounding did not mend spills by what it moved; vertices of B by what they were snapped.
  report.max_spill = std::max(report.max_move, rounded.report.max_spill) + report.max_snap;
  report.lost = rounded.report.lost;
  report.merges = rounded.report.merges;
  report.flips = rounded.report.flips;
  report.kinetic = rounded.report.kinetic;

  points = std::move(mesh.points);
  work.faces.clear();
  work.parents.clear();
  std::vector<Index> renumbered(mesh.faces.size(), none);
  std::vector<bool> live(regions.size(), false);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Face& face = mesh.faces[f];
    if (face[0] == none || mesh.labels[f] == none) continue;
    live[mesh.labels[f]] = true;
    renumbered[f] = static_cast<Index>(work.faces.size());
    work.faces.push_back(face);
    work.parents.push_back(regions[mesh.labels[f]]);
  }
  work.exterior = work.faces.size();
  for (Index f : rounded.relabelled)
    if (renumbered[f] != none) relabelled.push_back(renumbered[f]);
  for (std::size_t r = 0; r < regions.size(); ++r)
    report.collapsed += !live[r] && (regions[r][0] != none || regions[r][1] != none);
}

/// The vertices that faces use, in order; all of them, unless rounding merged or trimmed some.
std::vector<Index> used_vertices(const OverlayFaces& work, std::size_t vertices) {
  std::vector<std::uint8_t> used(vertices, 0);
  for (const Face& f : work.faces) used[f[0]] = used[f[1]] = used[f[2]] = 1;
  std::vector<Index> kept;
  for (std::size_t v = 0; v < vertices; ++v)
    if (used[v]) kept.push_back(static_cast<Index>(v));
  return kept;
}

template <class T>
void keep(Array<T>& values, const std::vector<Index>& kept) {
  for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
  values.resize(kept.size());
}

double four_ulp(const Tin& a, const Tin& b) {
  double largest = 0;
  for (const Tin* tin : {&a, &b})
    for (const Point& p : tin->vertices) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y)});
  return 4 * (std::nextafter(largest, INFINITY) - largest);
}

/// `as_given`: no vertex was moved or merged, and those of A come first, then those of B that are not A's, each in its
/// order.
Overlay refine(const Tin& a, const Tin& b, const OverlayOptions& options, Context& context, bool& as_given) {
  Overlay result;
  Prepared prepared = prepare(a, b, options.snap, context);
  result.rounding.snapped = prepared.b.count;
  result.rounding.max_snap = prepared.b.max_move;
  Arrangement arrangement =
      arrange(prepared.a, prepared.b.mesh, std::move(prepared.b.location), options.refinement, context);
  OverlayFaces work = faces_of(arrangement, options.refinement, context);
  result.rounding.regions = work.regions;
  result.rounding.max_move = arrangement.max_move;

  const FaceHeights heights[2] = {{a, arrangement, 0}, {b, arrangement, 1}};
  Array<Point2> points = std::move(arrangement.points);
  std::vector<Index> relabelled, vertex;
  const bool mended = !work.all_positive;
  as_given = !mended && prepared.b.count == 0;
  if (mended) {
    mend(arrangement, work, points, heights, options.refinement, result.rounding, context, relabelled);
    vertex = used_vertices(work, points.size());
  } else {
    result.rounding.max_spill = result.rounding.max_move + result.rounding.max_snap;
    work.faces.resize(work.exterior);
    work.parents.resize(work.exterior);
    points.resize(arrangement.first_corner);
  }
  context.progress("overlay", 0.9);

  const int surfaces = options.refinement == Refinement::outline ? 1 : 2;  // an outline has no heights
  for (int m = 0; m < surfaces; ++m) {
    result.per_corner[m] = arrangement.mesh[m]->jumps;
    Array<double>& z = result.heights[m];
    const auto in_face = [&](std::size_t f, int k) {
      const Index v = work.faces[f][k];
      return heights[m].at(work.parents[f][m], v, points[v]);
    };
    if (result.per_corner[m]) {
      z.assign(3 * work.faces.size(), 0);
      parallel_for(context, work.faces.size(), chunk_for(context, work.faces.size()),
                   [&](std::size_t begin, std::size_t end) {
                     for (std::size_t f = begin; f < end; ++f)
                       for (int k = 0; k < 3 && work.parents[f][m] != none; ++k) z[3 * f + k] = in_face(f, k);
                   });
    } else {
      z = std::move(arrangement.heights[m]);
      z.resize(points.size());
      std::vector<Index> changed = relabelled;
      std::erase_if(changed, [&](Index f) { return work.parents[f][m] == none; });
      const auto own_heights = [&](Index f) {
        return OwnHeights{{in_face(f, 0), in_face(f, 1), in_face(f, 2)},
                          heights[m].error(work.parents[f][m], result.rounding.max_move)};
      };
      result.per_corner[m] = mend_heights(work.faces, changed, own_heights, z);
    }
  }
  if (mended) {
    std::vector<Index> number(points.size(), none);
    for (std::size_t i = 0; i < vertex.size(); ++i) number[vertex[i]] = static_cast<Index>(i);
    for (Face& f : work.faces) f = {number[f[0]], number[f[1]], number[f[2]]};
    keep(points, vertex);
    for (int m = 0; m < surfaces; ++m)
      if (!result.per_corner[m]) keep(result.heights[m], vertex);
  }
  for (int m = 0; m < surfaces; ++m) {
    const CompletedMesh& mesh = *arrangement.mesh[m];
    if (mesh.face_in_tin.empty()) continue;
    for (std::array<Index, 2>& parents : work.parents)
      if (parents[m] != none) parents[m] = mesh.tin_face(parents[m]);
  }
  result.points = std::move(points);
  result.faces = std::move(work.faces);
  result.parents = std::move(work.parents);
  return result;
}

}  // namespace

Overlay overlay(const Tin& a, const Tin& b, const OverlayOptions& options, Context& context) {
  context.progress("overlay", 0);
  OverlayOptions resolved = options;
  if (resolved.snap < 0) resolved.snap = four_ulp(a, b);
  std::optional<Overlay> result;
  if (const auto divided = options.refinement == Refinement::full ? divide(a, b) : std::nullopt) {
    bool as_given = true;
    Overlay rests;
    if (!divided->rest[0].faces.empty())
      rests = refine(divided->rest[0], divided->rest[1], resolved, context, as_given);
    if (as_given && !rests.per_corner[0] && !rests.per_corner[1])
      result = put_together(*divided, a, b, std::move(rests));
  }
  bool as_given;
  if (!result) result = refine(a, b, resolved, context, as_given);
  context.progress("overlay", 1);
  return std::move(*result);
}

}  // namespace terrane
