// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/context.hpp"
#include "core/tin.hpp"

namespace terrane {

/// True area (m2, say) per unit of plan area at a place: how the geodesy of a CRS reaches the core. Smooth.
using AreaScale = std::function<double(double x, double y)>;

struct VolumeSide {
  double volume = 0, area_2d = 0, area_3d = 0, max_dz = 0;  // all non-negative; area_3d is that of the surface
};

/// Volumes between a surface and a reference over their overlap. fill: the surface is above by more than the tolerance;
/// cut: below; same: within. Computed in closed form on every face of the overlay, split at the lines dz = +-tolerance;
/// compensated sums.
struct Volume {
  VolumeSide fill, cut;
  double same_area_2d = 0, same_area_3d = 0;
  double net = 0;                       // integral of dz where |dz| > tolerance: fill.volume - cut.volume
  double overlap_area_2d = 0, surface_only_area_2d = 0, reference_only_area_2d = 0;
  double identity_residual = 0;         // |net - (integral of surface - integral of reference)| over the overlap, tolerance 0, else 0
};

/// `scale` weighs areas and volumes (area_3d stays in the plane's own metric times the scale); none counts as 1.
Volume volume(const Tin& surface, const Tin& reference, double tolerance, const AreaScale& scale, Context& context);
Volume volume(const Tin& surface, double level, double tolerance, const AreaScale& scale, Context& context);
/// For each level, in their order. O(faces + levels + places where a face passes a level).
std::vector<Volume> volumes(const Tin& surface, std::span<const double> levels, double tolerance,
                            const AreaScale& scale, Context& context);

/// Integral of z over the domain; the check that volume must agree with.
double integral(const Tin& tin, const AreaScale& scale);

/// Area of the domain in plan, weighted by `scale`.
double area(const Tin& tin, const AreaScale& scale);
/// The same without a scale.
double plan_area(const Tin& tin, const Context& context = {});

}  // namespace terrane
