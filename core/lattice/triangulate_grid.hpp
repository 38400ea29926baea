// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/context.hpp"
#include "core/raster.hpp"
#include "core/tin.hpp"

namespace terrane {

/// The TIN with every sample of the domain a vertex, in the order of the samples, row by row from the north-west. O(s).
Tin triangulate_every_sample(const Raster& dem, Context& context);

}  // namespace terrane
