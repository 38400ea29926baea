// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <exception>
#include <string>

#include "server/http/connection.hpp"

namespace terrane {

/// The whole answer of the front to a request that nobody else will see, after which the connection closes; logged.
std::string refusal(const Connection& connection, const std::exception& why);

}  // namespace terrane
