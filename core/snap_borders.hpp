// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/context.hpp"
#include "core/plan_metric.hpp"
#include "core/tin.hpp"

namespace terrane {

/// What snapping did to the tiles. Distances as the metric has them.
struct SnapReport {
  std::size_t moved = 0;     // border vertices that were moved onto another tile's border
  std::size_t inserted = 0;  // vertices made on borders so that the other tile's vertices have a mate
  std::size_t skipped = 0;   // vertices within the distance that had to stay: a face or the border would turn over
  double max_move = 0, mean_move = 0;
};

struct SnappedTiles {
  std::vector<Tin> tiles;  // canonical; those that nothing was moved in are as they came
  SnapReport report;
};

/// Moves border vertices of tiles (each checked) onto the original border of another tile where that is within
/// `distance` in plan, so that tiles which nearly meet meet exactly. Heights stay with their vertices.
///
/// Tiles have an order taken from their content, so that the order given does not matter: the tile that comes first
/// stays, the later one moves. First each vertex goes to the nearest vertex of an earlier tile, nearest pairs first;
/// what has moved is no target, so that nothing drifts further than `distance`. Then each vertex that neither moved nor
/// was moved to goes to the nearest edge of any other tile that still lies where it lay; that edge gets a vertex there,
/// with the height it has there. Last, where an edge has moved or a vertex has a mate already, the edge is led through
/// the vertex. So borders within the distance share their vertices, and nothing is left open between them.
///
/// No face is turned over or made flat, decided exactly, and no border comes to cross its own tile's: a move that would
/// is skipped and counted. A tile that does not verify in the end stays as it was. Tiles come without their walls where
/// they change, heights jumping openly. O(n + b log b) for n faces and b border edges, and what lies near them.
SnappedTiles snap_borders(const std::vector<Tin>& tiles, double distance, const PlanMetric& metric, Context& context);

}  // namespace terrane
