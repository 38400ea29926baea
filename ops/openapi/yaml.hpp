// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace terrane {

/// JSON as YAML 1.2 in block style; text is quoted wherever a reader could take it for something else.
std::string yaml(const nlohmann::json& value);

}  // namespace terrane
