// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The far side of server/worker/workers.hpp.
namespace terrane {

/// The whole life of the process that makes workers: it has loaded what they need, reads orders from the socket and
/// forks for each; ends, and all its workers with it, when the other end is closed. Returns the exit code.
int make_workers(int socket);

}  // namespace terrane
