// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "core/context.hpp"
#include "core/overlay.hpp"
#include "core/shapes.hpp"
#include "core/volume.hpp"

// Where a surface lies above, at and below its reference: the volume report as areas of the plane.
namespace terrane {

enum class VolumeKind { above, same, below };

/// One connected area, its interior in one piece.
struct VolumeArea {
  VolumeKind kind = VolumeKind::above;
  Polygon polygon;  // as core/plan/zone_polygons has it
  /// As volume() has them, of this area alone; same has no volume.
  double volume = 0, area_2d = 0, area_3d = 0, max_dz = 0;
};

struct VolumeAreas {
  std::vector<VolumeArea> areas;  // above, same, below; the largest first
  RoundingReport rounding;
};

/// sqrt(1 + slope^2) of a face; null where plan and heights are in one unit.
using Steepness = std::function<double(const Point&, const Point&, const Point&)>;

/// The partition of the overlap by volume()'s rule: above where the surface is higher by more than the tolerance, below
/// where it is lower by more, same between. Faces of the overlay are cut where the difference passes +-tolerance
/// (core/level_cuts), and equal areas dissolved, so polygons share borders and never overlap, and their figures add up
/// to volume()'s, each cut a rounding error off its exact place. With tolerance 0 faces without any difference are
/// same. Throws Error{input, "levels-too-close"} where the tolerance is neither 0 nor larger than what heights are told
/// apart by. O(n log n) in input + overlay.
VolumeAreas volume_areas(const Tin& surface, const Tin& reference, double tolerance, const AreaScale& scale,
                         const Steepness& steepness, Context& context);
VolumeAreas volume_areas(const Tin& surface, double level, double tolerance, const AreaScale& scale,
                         const Steepness& steepness, Context& context);

}  // namespace terrane
