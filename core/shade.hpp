// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/context.hpp"
#include "core/tin.hpp"

namespace terrane {

/// 8-bit RGBA, row by row from the top; alpha 0 where the TIN has no surface.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

struct ShadeOptions {
  int size = 1024;              // pixels along the longer side
  double azimuth_deg = 315;     // of the light
  double altitude_deg = 45;
  double z_factor = 1;          // height units per plan unit (metres per degree for geographic CRSs)
  double x_factor = 1;          // cos(latitude) for geographic CRSs, so that the picture is not stretched
};

/// A hillshade tinted by elevation (below 0: blues), seen from above; walls do not show. Orientation: north up. Gentle
/// relief is drawn up to 6 times as steep as it is, steep relief as it is. An empty TIN has a picture of 0 x 0.
/// O(faces + pixels).
Picture hillshade(const Tin& tin, const ShadeOptions& options, Context& context);

}  // namespace terrane
