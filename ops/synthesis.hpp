// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/tin.hpp"
#include "io/geodesy.hpp"
#include "ops/outcome.hpp"
#include "ops/parameters.hpp"

// What the synthesize-* operations share.
namespace terrane {

/// A length in plan as the core takes it: CRS units; metres where these are degrees, turned into degrees of latitude so
/// that no edge is longer.
double longest_edge(const Length& length, const Crs& crs);

/// Throws Error{usage, "missing-parameter"} where one of the parameters is not given.
void need_parameters(const nlohmann::json& parameters, const std::string& operation,
                     std::initializer_list<const char*> names);

/// A level mesh of what a simple ring encloses. Throws Error{input, "crosses-itself"} naming the place where the ring
/// meets itself; `what` it is: "the curve".
Outcome level_mesh(const std::vector<Point2>& ring, const std::string& what, const Length& z, const Length& max_edge,
                   const Crs& crs, Context& context);

}  // namespace terrane
