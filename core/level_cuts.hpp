// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "core/context.hpp"
#include "core/surface.hpp"
#include "core/tin.hpp"
#include "core/zones.hpp"

// A surface divided by height: what threshold and quantize are made of.
namespace terrane {

struct LevelZones {
  ZonedMesh mesh;  // zone: how many levels are not above the surface there
  RoundingReport rounding;
  /// No rounding brought a point of a zone's border further than this, in height, from the level it is of: on steep
  /// faces a place an ulp off lies as much higher as they are steep.
  double height_play = 0;
};

/// Divides a TIN into the zones between levels: zone i is {L[i - 1] <= z < L[i]}, so the area of a level is {z >= L}.
/// A zone takes in what of the domain it has in plan: where the surface only reaches a level, at a peak or along a
/// ridge, nothing is. Walls are looked through: beside one, each side is divided at its own heights, and every cut is a
/// point of the faces on both sides. Crossings of edges and levels are made once, from the edge's ends in an order of
/// their places, so that tiles that share an edge cut it at the same doubles; rounded and verified as in
/// core/rounding/rounding. The zones come dissolved (core/zones).
///
/// `levels` ascend. Throws Error{input} where two that the surface reaches are so close that doubles cannot keep their
/// crossings apart (1e-9 of the largest height), and where the surface crosses them more than 50 million times.
/// Precondition: valid and canonical (core/validate). O((n + c) log(n + c)) for c cuts.
LevelZones level_zones(const Tin& tin, std::span<const double> levels, Context& context);

/// The same division before it is dissolved, of heights that may jump between faces: for those who measure what lies in
/// the zones.
struct LevelPieces {
  ZonedMesh mesh;
  std::vector<Index> parent;  // per face: the face of `surface` it was cut from
  CornerSurface surface;      // as it was given
  RoundingReport rounding;
  double height_play = 0;  // as above
};
LevelPieces level_pieces(CornerSurface surface, std::span<const double> levels, Context& context);

/// The faces that lie level at one of the levels, exactly: the level decides on which side of it they count.
Tin flat_faces(const Tin& tin, std::span<const double> levels);

}  // namespace terrane
