// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/context.hpp"
#include "core/overlay.hpp"
#include "core/surface.hpp"

namespace terrane {

/// Who gives way where tiles meet: both within their overlap, the earlier one inside its border, or the later one
/// outside of it.
enum class BlendSide { both, inside, outside };

struct BlendOptions {
  double width = 0;  // > 0
  BlendSide side = BlendSide::both;
  double tolerance = 0.01;  // of heights, against the exact blend
  Point2 metric = {1, 1};   // what a unit along x and along y counts, in units of `width`
};

/// How near the faces come to the exact blend.
struct BlendReport {
  double bound = 0;   // proven: nowhere is the surface further from the exact blend
  Index made = 0;     // vertices made for it
  Index corners = 0;  // places where both borders meet
  double radius = 0;  // around such places the weight is not resolved
};
void accumulate(BlendReport& sum, const BlendReport& more);

struct Blended {
  Overlay overlay;             // refined; heights per corner
  std::vector<double> weight;  // of A, 3 * face + corner; 1 and 0 where only A or B is
  BlendReport report;
};

/// Refines a full overlay until weight * z_A + (1 - weight) * z_B, taken at the corners, is within the tolerance of
/// itself everywhere on the faces of both. weight = min(1, d_A / min(width, d_A + d_B)), with d_A the plan distance to
/// the part of A's border that lies inside B, and d_B likewise: 0 along A's border, 1 along B's, and beyond `width`
/// from A's. Faces are bisected at their longest edges (Rivara 1984), so that the mesh stays conforming and no face
/// becomes thinner than those there were by much; faces of one surface are cut where an edge of theirs is, and keep
/// their plane. The error is bounded face by face from the lines that can be nearest to some place of it
/// (core/merge/line_distance).
///
/// Where both borders meet the weight takes all values at one place. Nothing is promised within width / 1024 of it (of
/// the overlap's extent, where that is smaller), and the place has a height per face: along the borders none jumps.
Blended blend(Overlay overlay, const BlendOptions& options, Context& context);

struct Bent {
  CornerSurface surface;
  std::vector<Index> from;           // per face: the face of the overlay that it lies on
  std::vector<std::uint8_t> sloped;  // 1: its heights are no longer those of its input
  RoundingReport rounding;
  BlendReport report;
};

/// A pasted over B, and the one bent to the other that `side` says, for overlaps too narrow to blend in and for surveys
/// that must not change. The seam is A's border inside B, or along B. outside: A stays as it is, and to B outside of it
/// (1 - d / width) * D is added, with d the plan distance to the seam, and D what A is above B there: linear along the
/// seam, and from it to its value at the nearest place of the seam for places a width away and further, linear on the
/// triangles of a constrained Delaunay triangulation between. inside: the same to A, with D what B is above A. So
/// nothing jumps at the seam, and nothing at the other end of the band. Refined like blend(), with the same bound. The
/// overlay is a paste.
Bent bend(const Overlay& overlay, const BlendOptions& options, Context& context);

}  // namespace terrane
