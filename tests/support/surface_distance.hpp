// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/tin.hpp"

namespace terrane::support {

struct SurfaceDistance {
  double largest = 0;  // vertical, wherever both have a surface
  double shared = 0;   // area in plan of where they do
};

/// By clipping every face with every other one whose box meets it, in rationals: exact, and independent of the core.
/// Walls are looked through. For small meshes.
SurfaceDistance surface_distance(const Tin& a, const Tin& b);

}  // namespace terrane::support
