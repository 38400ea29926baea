// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>

namespace terrane {

/// `terrane serve`: parses its options and serves until told to stop.
int serve_command(std::span<const std::string> words);

}  // namespace terrane
