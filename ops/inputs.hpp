// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ops/operation.hpp"
#include "ops/outcome.hpp"

// What several operations ask of their inputs.
namespace terrane {

/// The input of that name; null when an optional one was not given.
Surface* find_input(std::vector<Surface>& inputs, std::string_view slot);
Surface& input(std::vector<Surface>& inputs, std::string_view slot);

/// Throws Error{input, "no-overlap"} saying how far apart the two are.
[[noreturn]] void refuse_no_overlap(const Surface& a, const Surface& b, const std::string& remedy = "allow-empty=true");
/// The same as a warning, for `allow-empty`.
void warn_no_overlap(const Surface& a, const Surface& b, Context& context);

/// The surface with its heights scaled, then raised. Throws Error{input, "overflow"} naming the vertex and what was
/// done, where a height gets too large to compute with.
Tin with_heights(Tin tin, double scale, double raise, const std::string& name, const std::string& doing);

/// Heights of one surface about 3.28 times the other's: feet beside metres.
void warn_feet_beside_metres(const Surface& a, const Surface& b, Context& context);

}  // namespace terrane
