// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/surface.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/corner_heights.hpp"
#include "core/error.hpp"
#include "core/surface/edge_cuts.hpp"
#include "core/surface/mend.hpp"
#include "core/surface/single_valued.hpp"
#include "core/surface/walls.hpp"

namespace terrane {
namespace {

/// Heights of both sides of an edge, at its ends as face f sees them.
struct Jump {
  double dp, dq;  // f minus g
};

Jump jump(const CornerSurface& surface, const Array<Face>& neighbours, Index f, int k) {
  const Index g = neighbours[f][k];
  int j = 0;
  while (surface.faces[g][(j + 1) % 3] != surface.faces[f][(k + 2) % 3]) ++j;
  const auto z = [&](Index face, int corner) { return surface.z[3 * static_cast<std::size_t>(face) + corner % 3]; };
  return {z(f, k + 1) - z(g, j + 2), z(f, k + 2) - z(g, j + 1)};
}

std::vector<EdgeCut> sign_changes(const CornerSurface& surface, const Array<Face>& neighbours) {
  std::vector<EdgeCut> cuts;
  for (Index f = 0; f < static_cast<Index>(surface.faces.size()); ++f)
    for (int k = 0; k < 3; ++k) {
      if (neighbours[f][k] <= f) continue;
      const Jump d = jump(surface, neighbours, f, k);
      if ((d.dp < 0 && d.dq > 0) || (d.dp > 0 && d.dq < 0)) cuts.push_back({f, k, d.dp, d.dq});
    }
  return cuts;
}

/// Where the zero point of a jump rounded onto a vertex, the jump there is within rounding of zero: both heights become
/// that of the first face. On an edge as short as rounding that can be any jump: then only the face beside it, which is
/// as thin, gives way.
struct Closure {
  Index point;
  double from, to;
  Index face;  // before the cuts

  bool covers(Index of, double z) const {
    return z == from && (of == face || std::fabs(to - from) <= height_rounding(from));
  }
};

/// Closes the jump between f and the face across from its corner k, at another of its corners.
Closure closure(const CornerSurface& surface, const Array<Face>& neighbours, Index f, int k, int corner) {
  const Index g = neighbours[f][k], w = surface.faces[f][corner];
  int j = 0;
  while (surface.faces[g][j] != w) ++j;
  return {w, surface.z[3 * static_cast<std::size_t>(g) + j], surface.z[3 * static_cast<std::size_t>(f) + corner], g};
}

std::vector<Closure> closures(const CornerSurface& before, const Array<Face>& neighbours, const CutMesh& cut) {
  std::vector<Closure> found;
  for (std::size_t i = 0; i < cut.made.size(); ++i) {
    const Index v = cut.first_made + static_cast<Index>(i), w = cut.rounded.merged_into[v];
    if (w == v) continue;
    const CutVertex& made = cut.made[i];
    const Index f = made.owners[0];
    const Face& face = before.faces[f];
    for (int k = 0; k < 3; ++k) {
      const bool edge = (face[(k + 1) % 3] == made.p && face[(k + 2) % 3] == made.q) ||
                        (face[(k + 1) % 3] == made.q && face[(k + 2) % 3] == made.p);
      if (!edge || (w != made.p && w != made.q)) continue;
      const int corner = face[(k + 1) % 3] == w ? (k + 1) % 3 : (k + 2) % 3;
      const Jump d = jump(before, neighbours, f, k);
      if (d.dp != 0 || d.dq != 0) found.push_back(closure(before, neighbours, f, k, corner));
    }
  }
  return found;
}

/// `labels`: the face before the cuts that each face lies on; when null, all that share a height that closes give way.
void apply(std::vector<Closure> closures, const Array<Index>* labels, CornerSurface& surface) {
  if (closures.empty()) return;
  std::stable_sort(closures.begin(), closures.end(), [](auto& a, auto& b) { return a.point < b.point; });
  for (std::size_t c = 0; c < surface.z.size(); ++c) {
    const Index point = surface.faces[c / 3][c % 3];
    auto it = std::lower_bound(closures.begin(), closures.end(), point, [](auto& a, Index p) { return a.point < p; });
    for (; it != closures.end() && it->point == point; ++it)
      if (labels ? it->covers((*labels)[c / 3], surface.z[c]) : surface.z[c] == it->from) surface.z[c] = it->to;
  }
}

/// Closes the jumps whose zero points lie within rounding of an end, rather than cut there. Were there any?
bool close_near_ends(const Array<Face>& neighbours, const std::vector<EdgeCut>& cuts, CornerSurface& surface) {
  std::vector<Closure> closures;
  for (const EdgeCut& cut : cuts) {
    const int i = (cut.side + 1) % 3, j = (cut.side + 2) % 3;
    const Face& face = surface.faces[cut.face];
    const ExactPlace zero{.kind = ExactPlace::ratio,
                          .p = surface.points[face[i]],
                          .q = surface.points[face[j]],
                          .dp = cut.dp,
                          .dq = cut.dq};
    const double length = std::hypot(zero.q.x - zero.p.x, zero.q.y - zero.p.y), t = cut.dp / (cut.dp - cut.dq);
    if (std::min(t, 1 - t) * length <= 3 * rounding_bound(zero))
      closures.push_back(closure(surface, neighbours, cut.face, cut.side, t <= 0.5 ? i : j));
  }
  apply(closures, nullptr, surface);
  return !closures.empty();
}

/// Makes the zero points of jumps that change sign along an edge vertices of both faces.
CornerSurface cut_at_zero_points(CornerSurface before, PlanarMesh mesh, const std::vector<EdgeCut>& cuts,
                                 bool close_anyway, RoundingReport& report, Context& context) {
  const Array<Face> neighbours = mesh.neighbours;
  CutMesh cut = cut_edges(std::move(mesh), cuts, Chords::none, context);
  accumulate(report, cut.rounded.report);
  CornerSurface after;
  after.faces = cut.mesh.faces;
  after.z.resize(3 * after.faces.size());
  after.firm.assign(after.z.size(), 0);
  for (std::size_t f = 0; f < after.faces.size(); ++f) {
    const std::size_t label = cut.mesh.labels[f];
    const Face& old = before.faces[label];
    for (int k = 0; k < 3; ++k) {
      const Index v = after.faces[f][k];
      after.z[3 * f + k] = value_on(cut, before.points, old, &before.z[3 * label], v);
      const auto at = std::find(old.begin(), old.end(), v) - old.begin();
      if (at < 3 && !before.firm.empty()) after.firm[3 * f + k] = before.firm[3 * label + at];
    }
  }
  apply(closures(before, neighbours, cut), close_anyway ? nullptr : &cut.mesh.labels, after);
  after.points = std::move(cut.mesh.points);
  return after;
}

}  // namespace

void accumulate(RoundingReport& sum, const RoundingReport& more) {
  sum.max_move = std::max(sum.max_move, more.max_move);
  sum.max_snap = std::max(sum.max_snap, more.max_snap);
  sum.max_spill = std::max(sum.max_spill, more.max_spill);
  sum.snapped += more.snapped;
  sum.merges += more.merges;
  sum.flips += more.flips;
  sum.kinetic += more.kinetic;
  sum.lost += more.lost;
  sum.regions += more.regions;
  sum.collapsed += more.collapsed;
}

Assembled assemble(CornerSurface surface, const Assembly& assembly, Context& context) {
  Assembled result;
  PlanarMesh mesh;
  // Every round leaves edges whose jump keeps its sign; rounding a zero point onto an end can give another edge there a
  // new one, which the next round finds. Two rounds are common, three rare; thin faces in a ring may pass a jump on.
  // Two surfaces that a thin face joins may cross beside its tip, first on one side of it, then on the other: each cut
  // takes off no more of the tip than rounding does, and there is no end to it but at one height.
  for (int round = 0; round < 16; ++round) {
    context.progress("assemble", round == 0 ? 0 : 0.5);
    if (auto tin = single_valued(surface)) {
      result.tin = canonical(*std::move(tin), context);
      context.progress("assemble", 1);
      return result;
    }
    const CornersByPlace places = corners_by_place(surface.faces, surface.points.size());
    result.max_closed_jump = std::max(result.max_closed_jump, close_jumps(surface, places, assembly.z_tolerance));
    mesh = PlanarMesh{surface.points, surface.faces, {}, {}};
    connect(mesh);
    const std::vector<EdgeCut> cuts = sign_changes(surface, mesh.neighbours);
    if (cuts.empty()) {
      Walled walled = raise(surface, mesh.neighbours, assembly.seam != Seam::split);
      result.wall_area = walled.wall_area;
      result.tin = canonical(std::move(walled.tin), context);
      context.progress("assemble", 1);
      return result;
    }
    if (round > 7 && close_near_ends(mesh.neighbours, cuts, surface)) continue;
    surface = cut_at_zero_points(std::move(surface), std::move(mesh), cuts, round > 3, result.rounding, context);
  }
  throw Error(ErrorKind::input, "rounding",
              "the heights of two surfaces cross too often along one seam to be rounded; raise z-tolerance");
}

}  // namespace terrane
