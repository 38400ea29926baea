// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "ops/operation.hpp"

namespace terrane {

/// The OGC name of an operation's one output: surface, report or picture.
std::string output_id(const Operation& operation);

/// JSON Schema of a parameter's value.
nlohmann::json parameter_schema(const Parameter& parameter);

}  // namespace terrane
