// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/context.hpp"
#include "core/overlay.hpp"
#include "core/tin.hpp"

// From heights per corner back to a TIN: where faces disagree about the height of a place, the seam decides.
namespace terrane {

/// Jumps are closed by vertical faces, sloped down within the faces beside them (core/merge/ramp), or left open.
enum class Seam { wall, ramp, split };

/// Faces in plan with a height at every corner: what an overlay becomes once its heights are folded.
struct CornerSurface {
  Array<Point2> points;
  Array<Face> faces;
  std::vector<double> z;  // 3 * face + corner
  /// 1 where z is the height of an input vertex as it came: welding keeps such a height and moves the interpolated
  /// ones. Empty: no height is dearer than another.
  std::vector<std::uint8_t> firm = {};  // 3 * face + corner
};

/// Sums counts and takes the larger of distances: the report of one computation after another.
void accumulate(RoundingReport& sum, const RoundingReport& more);

struct Assembly {
  Seam seam = Seam::wall;
  double z_tolerance = 0;  // jumps up to this close at the height of the face that comes first
};

struct Assembled {
  Tin tin;
  RoundingReport rounding;
  double wall_area = 0;
  double max_closed_jump = 0;  // the largest jump that z_tolerance or welding closed
  /// In plan, at height 0: the faces that seam=ramp has sloped, where the surface is no longer that of an input.
  Tin ramps;
};

/// The TIN of a corner surface. Jumps along shared edges: up to 1e-9 * max(1, |z|) they are rounding and welded; up to
/// z_tolerance closed; larger ones become walls or stay open (Seam::split). What can be ramped has been
/// (core/merge/ramp), so that Seam::ramp makes walls of the rest. Where a jump changes sign along an edge the zero
/// point becomes a vertex of both faces. Each place holds one vertex per height; every wall face has two corners with
/// identical x and y, turned so that surface and walls are one oriented surface; vertical edges conform: none passes
/// through a vertex at its place. Points lie at different places, faces are strictly positive and conform. The result
/// is canonical. O(n log n).
Assembled assemble(CornerSurface surface, const Assembly& assembly, Context& context);

/// Splits the faces of an overlay along the lines where the heights of A and B cross, so that on every face one of the
/// two is nowhere below the other (but for what rounding flips across the line). Parents stay; at a new vertex both
/// heights are the same double. Where an input jumps across an edge its two sides may cross the other surface at two
/// places: both become vertices of both faces. The new vertices are rounded and verified like crossings. O(n).
Overlay split_where_surfaces_cross(Overlay overlay, Context& context);

}  // namespace terrane
