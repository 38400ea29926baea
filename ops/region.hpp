// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/context.hpp"
#include "core/plan_region.hpp"
#include "io/vectors.hpp"

namespace terrane {

/// The area that the polygons of a parameter enclose, closed lines and written-out corners among them. `name` is the
/// parameter's, for messages. Throws Error{input}: "no-polygons", "empty-region". Warns of rings that cross themselves.
PlanRegion area_of(const Vectors& vectors, const std::string& name, Context& context);

}  // namespace terrane
