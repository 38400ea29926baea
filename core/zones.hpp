// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/context.hpp"
#include "core/surface.hpp"

// Areas of the plane that are told apart by a number: below and above a level, terraces, true and false.
namespace terrane {

/// A triangulated piece of the plane, each face in a zone. Faces are strictly positive and conform; points lie at
/// different places.
struct ZonedMesh {
  Array<Point2> points;
  Array<Face> faces;
  std::vector<Index> zone;  // per face, 0 and up
  /// 1 where a point was constructed, on an edge or where two edges cross: its place is rounded, and it may go where
  /// the border of a zone runs straight on. Empty: no point may.
  std::vector<std::uint8_t> constructed = {};
};

/// Faces of one zone that hang together are a piece of it.
struct ZonePieces {
  Array<Face> neighbours;  // of each face, across the edge opposite each corner; none on the border
  std::vector<Index> piece_of_face;
  std::vector<Index> zone_of_piece;
};
ZonePieces pieces_of(const ZonedMesh& mesh);

/// The same zones with no more points than their borders need, each zone triangulated anew (constrained Delaunay).
/// Borders keep their places: a point goes only where exactly two border edges meet in it, and they are collinear, or
/// the point was constructed and lies within `tolerance` of the line between the points that stay. Where leaving out
/// such points would make borders touch or cross, which the triangulation finds out exactly, they stay. O(n + b log b),
/// b points on borders.
ZonedMesh dissolve(const ZonedMesh& mesh, double tolerance, Context& context);

/// The zone of a face that lies in these zones of A and of B; `none` stands for no zone, of an input and of the result,
/// where such faces are left out.
using ZoneFold = std::function<Index(Index a, Index b)>;

/// The zones of two meshes folded into those of one, dissolved. The common refinement is core/overlay's, with its
/// promises: exact topology, each crossing made once, rounded and verified. Inputs should be dissolved, lest every edge
/// inside a zone is cut, too.
ZonedMesh fold_zones(const ZonedMesh& a, const ZonedMesh& b, const ZoneFold& fold, RoundingReport& rounding,
                     Context& context);

/// The surface that is level in every zone, at the height given for it; walls join zones of different heights, cut at
/// every height of their places. Heights closer than 1e-9 * max(1, |z|) become one.
Assembled lifted(const ZonedMesh& mesh, std::span<const double> heights, Context& context);

}  // namespace terrane
