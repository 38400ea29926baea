// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "ops/operation.hpp"

namespace terrane {

/// A command that runs an operation at the service `base`.
std::string example_command(const Operation& operation, const std::string& base);

/// JSON Schema of a parameter's value.
nlohmann::json parameter_schema(const Parameter& parameter);

}  // namespace terrane
