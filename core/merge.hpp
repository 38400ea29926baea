// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "core/merge/blend.hpp"
#include "core/merge/gaps.hpp"
#include "core/plan_metric.hpp"
#include "core/surface.hpp"
#include "core/tin.hpp"

namespace terrane {

enum class Overlap { first, last, min, max, mean, median, sum, blend };

struct MergeOptions {
  Overlap overlap = Overlap::first;
  Assembly assembly = {};
  std::optional<double> level = {};  // of min and max: a tile of this height wherever the others are
  double gap = 0;                    // slits between tiles up to this width are bridged (core/merge/gaps)
  PlanMetric metric = {};            // of the gap, and of what is said about seams
  BlendOptions blend = {};           // of blend
};

/// What lies between two tiles, from the tiles as they came, before any policy. dz = height of b - height of a.
/// Lengths and areas as the metric has them, heights in CRS units.
struct SeamPair {
  int a = 0, b = 0;      // indices of the tiles, a < b
  bool overlap = false;  // false: they share only a border
  double overlap_area_2d = 0;
  double dz_mean = 0, dz_median = 0, dz_rmse = 0, dz_nmad = 0, dz_p95_abs = 0;  // area-weighted over the overlap
  // Jumps left in the merged surface along the seam of this pair.
  std::size_t jump_count = 0;
  double jump_length_2d = 0, jump_max_abs = 0, jump_mean_abs = 0, jump_rmse = 0;  // means weighted by length
  Point2 jump_max_at;
  bool bias_suspected = false;  // |median| > 3 * nmad / sqrt(effective samples) and the overlap is not tiny
  double wall_area = 0;
};

/// A piece of a seam along which heights jump: from p to q, by dp to dq, the height of b - that of a.
struct SeamJump {
  int a = 0, b = 0;  // as in its pair
  Point2 p, q;
  double dp = 0, dq = 0;
};

struct Merged {
  Assembled surface;
  Bridged bridged;
  std::vector<SeamPair> seams;  // pairs that overlap or touch, ordered by (a, b)
  std::vector<SeamJump> jumps;  // those counted in the pairs, in their order and along x
  BlendReport blend;
};

/// Tiles by their content alone, those first that merge() takes first: along x, then y; equal boxes by what is in them.
std::vector<int> order_by_content(const std::vector<Tin>& tiles);

/// One TIN of n tiles (each checked). Pairwise overlays in an order taken from the tiles' content, so that min, max,
/// mean, median and sum give the same bytes for any order given; first and last paste in the order given, and blend
/// fades each tile into those before it (core/merge/blend). Seam::ramp slopes jumps after every tile (core/merge/ramp).
/// Where tiles share only a border it is made conforming. Islands are never connected. Empty tiles are the identity.
/// Time grows with the tiles: faces far from the tile being added are not visited by its overlay.
Merged merge(const std::vector<Tin>& tiles, const MergeOptions& options, Context& context);

}  // namespace terrane
