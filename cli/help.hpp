// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "ops/operation.hpp"

namespace terrane {

std::string general_help();
std::string operation_help(const Operation& operation);
std::string serve_help();

}  // namespace terrane
