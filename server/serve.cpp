// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/serve.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

#include <unistd.h>

#include "core/error.hpp"
#include "ops/errors.hpp"
#include "server/routes.hpp"

namespace terrane {

namespace {

// Container engines kill after ten seconds.
constexpr int grace_seconds = 4;   // for requests in flight to finish by themselves
constexpr int cancel_seconds = 5;  // for them to notice that they shall stop

sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGINT);
  return set;
}

/// Sleeps in small steps until the time is over or the server has finished; true when it has.
bool finishes_within(int seconds, const std::atomic<bool>& finished) {
  // By the clock: on a busy machine every step takes longer than it says.
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
  while (!finished && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return finished;
}

/// Waits for a signal, then stops the server: at once for new work, in steps for what is in flight.
void watch_signals(HttpServer& server, Service& service, const std::atomic<bool>& finished) {
  const sigset_t set = stop_signals();
  const timespec step{0, 200'000'000};
  while (sigtimedwait(&set, nullptr, &step) < 0) {
    if (finished) return;
  }
  service.close();
  server.stop();
  if (finishes_within(grace_seconds, finished)) return;
  service.cancel();
  if (finishes_within(cancel_seconds, finished)) return;
  std::fputs("terrane: requests in flight did not stop in time; leaving them\n", stderr);
  std::_Exit(exit_code(ErrorKind::internal));
}

void check(const ServeOptions& options) {
  if (options.port < 0 || options.port > 65535) {
    throw Error(ErrorKind::usage, "out-of-range",
                "--port is " + std::to_string(options.port) + "; ports are 0 to 65535.");
  }
  if (options.max_body == 0 || options.max_body > std::size_t{1} << 40) {
    throw Error(ErrorKind::usage, "out-of-range", "--max-body must be from 1 byte to 1 TB.");
  }
  if (options.threads < 0 || options.threads > 1024) {
    throw Error(ErrorKind::usage, "out-of-range", "--threads must be from 1 to 1024, or 0 for one per core.");
  }
}

/// The folder of the service's files, made when it is not there.
std::string data_folder(const std::string& wanted) {
  namespace fs = std::filesystem;
  const char* const state = std::getenv("XDG_STATE_HOME");
  const char* const home = std::getenv("HOME");
  fs::path folder = wanted;
  if (wanted.empty() && state && *state) folder = fs::path(state) / "terrane";
  else if (wanted.empty() && home && *home) folder = fs::path(home) / ".local" / "state" / "terrane";
  else if (wanted.empty()) folder = fs::temp_directory_path() / "terrane";
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || access(folder.c_str(), W_OK | X_OK) != 0) {
    throw Error(ErrorKind::usage, "no-data-folder",
                "--data: " + folder.string() + " cannot be made or written; choose another folder.");
  }
  return folder.string();
}

}  // namespace

int serve(const ServeOptions& options) {
  check(options);
  ServiceLimits limits;
  limits.max_body = options.max_body;
  limits.slots = options.threads > 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
  limits.line = 2 * limits.slots;

  // Blocked before any thread exists, so that all inherit it and only the watcher sees the signals.
  const sigset_t signals = stop_signals();
  sigset_t before;
  pthread_sigmask(SIG_BLOCK, &signals, &before);
  std::signal(SIGPIPE, SIG_IGN);

  Service service(limits);
  HttpServer server(service, {static_cast<std::size_t>(limits.slots + limits.line), limits.max_body,
                              data_folder(options.data)});
  const int port = server.bind(options.host, options.port);
  const std::string host = options.host.find(':') == std::string::npos ? options.host : "[" + options.host + "]";
  std::printf("listening on http://%s:%d\n", host.c_str(), port);
  std::fflush(stdout);

  std::atomic<bool> finished = false;
  std::thread watcher([&] { watch_signals(server, service, finished); });
  const bool clean = server.run();
  finished = true;
  watcher.join();
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (!clean) throw Error(ErrorKind::internal, "socket-failed", "The listening socket failed.");
  return 0;
}

}  // namespace terrane
