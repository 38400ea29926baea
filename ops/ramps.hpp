// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/tin.hpp"
#include "io/geodesy.hpp"
#include "ops/outcome.hpp"

namespace terrane {

/// Heights are promised outside the ramps only: where they are the check is told to expect nothing, and the
/// certificate says under `name` how large they are. The outcome has its fields and its expected height already.
/// Nothing happens where there are no ramps.
void leave_ramps_out(Tin ramps, const char* name, const Crs& crs, Outcome& outcome, Context& context);

}  // namespace terrane
