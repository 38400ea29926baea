// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "server/request_log.hpp"

// The HTTP door: the operations of the catalogue as OGC API - Processes, executed while the client waits.
namespace terrane {

/// How the service runs. server/settings says of each what it means, its bounds, and where it can be set.
struct ServeOptions {
  std::string config;
  std::string host = "127.0.0.1";  // DEFAULT: loopback only
  int port = 8080;
  std::string data;
  std::string store = "sqlite";
  int threads = 0;
  std::size_t max_body = std::size_t{1} << 30;
  std::size_t sync_limit = std::size_t{256} << 20;
  int sync_time = 120;
  std::size_t job_memory = std::size_t{4} << 30;
  int job_time = 3600;
  int job_expiry = 86400;
  int max_jobs = 1000;
  std::vector<std::string> allow_hosts;
  std::string token_file;
  bool allow_anonymous = false;
  std::vector<std::string> cors_origins = {"*"};
  LogLevel log_level = LogLevel::info;
};

/// Listens, prints one line "listening on http://HOST:PORT" on standard output when ready, and returns after SIGTERM or
/// SIGINT: no new connections; requests in flight finish, or are asked to stop after 4 s and answered with 503; it
/// takes 10 s at most. One JSON line per request goes to standard error, and one each for start and stop.
///
/// Returns 0 after a clean stop. Throws Error{usage} when the address cannot be bound ("port-in-use": another program
/// listens there), and when it is not a loopback address and anybody could come in ("anonymous"). Called once per
/// process, before other threads are started: it handles the two signals of the whole process.
int serve(const ServeOptions& options);

}  // namespace terrane
