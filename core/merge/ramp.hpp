// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/surface.hpp"

namespace terrane {

/// Which height holds along a border that two lone surfaces share.
enum class Meeting { mean, lower, higher };

/// What a folded overlay is, face by face, for its seams to be ramped.
struct RampGround {
  /// Of a face outside: which surface it is of, and which face of it.
  std::vector<std::array<Index, 2>> origin = {};
  /// 0: outside. Where heights differ the face of higher rank holds its own: the overlap, a surface that must not move;
  /// of several overlaps that of more tiles.
  std::vector<int> rank = {};
  /// Twice the area in plan of a face of a surface.
  std::function<double(Index surface, Index face)> area = {};
  const std::vector<Index>* classes = nullptr;  // faces of different class are never made one; none: all alike
};

struct Ramped {
  CornerSurface surface;
  std::vector<Index> from;           // per face: a face of before, of the same input and class, that it replaces
  std::vector<std::uint8_t> sloped;  // 1: its heights are no longer those of its input
};

/// Turns the jumps at the border of what is held into slopes (seam=ramp). What is left outside of the faces that this
/// border cuts is triangulated anew, constrained by the border, by the edges of all other faces, and by edges along
/// which the input itself jumps; no point is made. Vertices on the border take the height that is held there, in whole
/// faces as well that only touch the border; every other vertex keeps its own, and faces with no jump at a corner stay
/// as they are. Overlaps of different rank slope to each other in their faces as they are. Where two lone surfaces
/// share a border both slope to the height that `meeting` says. A connected part outside all of whose corners lie at
/// the border has no room for a slope (a hole no larger than the faces around it): it keeps its heights, and its jumps
/// are left for assemble(). Faces stay strictly positive and conforming, exactly. O(n + b log b), b what is
/// triangulated anew.
Ramped ramp(CornerSurface surface, const RampGround& ground, Meeting meeting, Context& context);

/// Some of the faces as a TIN in plan, at height 0.
Tin faces_in_plan(const Array<Point2>& points, const Array<Face>& faces, const std::vector<std::uint8_t>& wanted);

}  // namespace terrane
