// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/context.hpp"
#include "core/surface.hpp"
#include "core/tin.hpp"

namespace terrane {

enum class Outside { keep, drop, zero };

/// z_a + z_b (sign = +1) or z_a - z_b (sign = -1) on the overlap, exact everywhere because both are linear on every
/// face of the overlay. Outside the overlap: drop: nothing is returned; keep: the lone surface at its own height (a
/// difference has none: Error{usage}); zero: the missing one counts as height 0. With Seam::ramp the outside slopes to
/// the overlap, and where both end at one border to the mean of the two. Both are valid (core/validate). For
/// canonical a and b, a + b and b + a are the same bytes, and b - a is a - b with every height negated. O(n log n) in
/// input + output.
Assembled combine(const Tin& a, const Tin& b, int sign, Outside outside, const Assembly& assembly, Context& context);

/// The surface with `level` added (a number as the second surface): every vertex moves, nothing else.
Tin offset(Tin a, double level);

}  // namespace terrane
