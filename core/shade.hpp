// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "core/context.hpp"
#include "core/picture/colour_scale.hpp"
#include "core/picture/picture.hpp"
#include "core/tin.hpp"

namespace terrane {

struct ShadeOptions {
  int size = 1024;           // pixels along the longer side
  double azimuth_deg = 315;  // of the light
  double altitude_deg = 45;
  double z_factor = 1;  // height units per plan unit (metres per degree for geographic CRSs)
  double x_factor = 1;  // cos(latitude) for geographic CRSs, so that the picture is not stretched
  /// The colours of heights; none: greens, browns and white, below 0 blues, for a hillshade.
  std::optional<ColourScale> colours = {};
  double relief = 1;       // how much the light counts: 0 leaves the colours alone
  bool wireframe = false;  // the edges of all faces over it, paler where they are dense
};

/// A hillshade tinted by elevation, seen from above; walls do not show. Orientation: north up. Gentle relief is drawn
/// up to 6 times as steep as it is, steep relief as it is. An empty TIN has a picture of 0 x 0. O(faces + pixels).
Picture hillshade(const Tin& tin, const ShadeOptions& options, Context& context);

}  // namespace terrane
