// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

// The HTTP door: the operations of the catalogue as OGC API - Processes, executed while the client waits.
namespace terrane {

struct ServeOptions {
  std::string host = "127.0.0.1";               // DEFAULT: loopback only
  int port = 8080;                              // 0: a free one, named on standard output
  std::string data;                             // folder of the jobs' results; empty: the user's state directory
  std::string store = "sqlite";                 // in the data folder; or postgresql://..., shared by several servers
  std::vector<std::string> allow_hosts;         // for references and callbacks
  std::size_t max_body = std::size_t{1} << 30;  // bytes of one request's body, counted while it is read and decoded
  int threads = 0;                              // executions at the same time; 0: one per core
};

/// Listens, prints one line "listening on http://HOST:PORT" on standard output when ready, and returns after SIGTERM or
/// SIGINT: no new connections; requests in flight finish, or are asked to stop after 4 s and answered with 503; it
/// takes 10 s at most. One JSON line per request goes to standard error.
///
/// Returns 0 after a clean stop. Throws Error{usage} when the options are out of range or the address cannot be bound
/// ("port-in-use": another program listens there). Called once per process, before other threads are started: it
/// handles the two signals of the whole process.
int serve(const ServeOptions& options);

}  // namespace terrane
