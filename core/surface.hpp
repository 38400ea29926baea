// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/context.hpp"
#include "core/overlay.hpp"
#include "core/tin.hpp"

// From heights per corner back to a TIN: where faces disagree about the height of a place, the seam decides.
namespace terrane {

enum class Seam { wall, ramp, split };

/// Faces in plan with a height at every corner: what an overlay becomes once its heights are folded.
struct CornerSurface {
  std::vector<Point2> points;
  std::vector<Face> faces;
  std::vector<double> z;  // 3 * face + corner
};

struct Assembly {
  Seam seam = Seam::wall;
  double z_tolerance = 0;  // jumps up to this close at the height of the face that comes first
};

struct Assembled {
  Tin tin;
  RoundingReport rounding;
  double wall_area = 0;
  double max_closed_jump = 0;  // the largest jump that z_tolerance or welding closed
};

/// The TIN of a corner surface. Jumps along shared edges: up to 1e-9 * max(1, |z|) they are rounding and welded; up to
/// z_tolerance closed; larger ones become walls (Seam::wall) or stay open (Seam::split). Where a jump changes sign along an edge the zero point
/// becomes a vertex. Each place holds one vertex per height; every wall face has two corners with identical x and y.
Assembled assemble(CornerSurface surface, const Assembly& assembly, Context& context);

/// Splits the faces of an overlay along the lines where the heights of A and B cross, so that on every face one of the two
/// is nowhere below the other. The new vertices are rounded and verified like crossings.
Overlay split_where_surfaces_cross(Overlay overlay, Context& context);

}  // namespace terrane
