// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/command_line.hpp"

namespace terrane {

/// Runs an operation on files: inputs in the declared order, the result to -o, the certificate to --report.
void run_operation(const Operation& operation, const CommandLine& line);

}  // namespace terrane
