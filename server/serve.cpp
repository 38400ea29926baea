// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/serve.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include "core/error.hpp"
#include "ops/errors.hpp"
#include "ops/operation.hpp"
#include "server/policy.hpp"
#include "server/request_log.hpp"
#include "server/routes.hpp"
#include "server/worker/sandbox.hpp"

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

/// How far the stop is: every request answered; and all jobs handed back.
struct Progress {
  std::atomic<bool> finished = false, stopped = false;
};

/// Whatever holds up the stop, a request, a job or a store that cannot be reached, is left.
void guard_stop(const Progress& progress) {
  if (finishes_within(grace_seconds + cancel_seconds, progress.stopped)) return;
  std::fputs("terrane: requests or jobs in flight did not stop in time; leaving them\n", stderr);
  std::_Exit(exit_code(ErrorKind::internal));
}

/// Waits for a signal, then stops the server: at once for new work, in steps for what is in flight. The guard begins
/// then.
void watch_signals(HttpServer& server, Service& service, const Progress& progress, std::thread& guard) {
  const sigset_t set = stop_signals();
  const timespec step{0, 200'000'000};
  while (sigtimedwait(&set, nullptr, &step) < 0) {
    if (progress.finished) return;
  }
  guard = std::thread(guard_stop, std::cref(progress));
  log_event(LogLevel::info, "stopping");
  service.close();
  server.stop();
  if (!finishes_within(grace_seconds, progress.finished)) service.cancel();
}

bool is_loopback(const std::string& host) {
  return host == "localhost" || host == "::1" ||
         (host.starts_with("127.") && host.find_first_not_of("0123456789.") == std::string::npos);
}

/// Whoever reaches the port may use the service; that has to be wanted.
void check_who_comes_in(const ServeOptions& options) {
  if (is_loopback(options.host) || !options.token_file.empty() || options.allow_anonymous) return;
  throw Error(ErrorKind::usage, "anonymous",
              "On " + options.host +
                  " anybody who reaches the port could use the service: give tokens with --token-file, or say "
                  "--allow-anonymous where something else keeps strangers away.");
}

ServiceLimits limits_of(const ServeOptions& options) {
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  ServiceLimits limits;
  limits.max_body = options.max_body;
  limits.slots = options.threads > 0 ? options.threads : cores;
  limits.line = 2 * limits.slots;
  limits.sync_bytes = options.sync_limit;
  limits.sync_seconds = options.sync_time;
  limits.jobs.runners = limits.slots;
  limits.jobs.seconds = options.job_time;
  limits.jobs.expiry_ms = std::int64_t{1000} * options.job_expiry;
  limits.jobs.max_waiting = static_cast<std::size_t>(options.max_jobs);
  limits.jobs.worker.memory = options.job_memory;
  // The processor's time of all threads together: no more than the time on the clock allows.
  limits.jobs.worker.cpu_seconds = static_cast<std::uint64_t>(options.job_time) * static_cast<std::uint64_t>(cores);
  return limits;
}

ServicePlace place_of(const ServeOptions& options) {
  ServicePlace place;
  place.data = options.data.empty() ? default_data_folder().string() : options.data;
  place.store = options.store;
  place.allow_hosts = options.allow_hosts;
  place.worker_command = {std::filesystem::read_symlink("/proc/self/exe").string(), "workers"};
  return place;
}

/// What is measured when somebody asks for the metrics.
void watch(Metrics& metrics, Service& service) {
  metrics.watch("terrane_executions", "Executions at work and in the line.", "state", [&]() -> Measured {
    const auto [running, waiting] = service.load();
    return {{"running", static_cast<double>(running)}, {"waiting", static_cast<double>(waiting)}};
  });
  metrics.watch("terrane_jobs", "Jobs by status.", "status", [&] {
    const std::vector<std::size_t> counts = service.jobs();
    Measured measured;
    for (std::size_t i = 0; i < counts.size(); ++i)
      measured.emplace_back(word(static_cast<JobStatus>(i)), static_cast<double>(counts[i]));
    return measured;
  });
}

}  // namespace

int serve(const ServeOptions& options) {
  check_who_comes_in(options);
  set_log_level(options.log_level);
  Policy policy(options.token_file.empty() ? Tokens() : Tokens::from_file(options.token_file), options.cors_origins);
  // Blocked before any thread exists, so that all inherit it and only the watcher sees the signals.
  const sigset_t signals = stop_signals();
  sigset_t before;
  pthread_sigmask(SIG_BLOCK, &signals, &before);
  std::signal(SIGPIPE, SIG_IGN);

  const ServiceLimits limits = limits_of(options);
  Service service(limits, place_of(options));
  watch(policy.metrics(), service);
  HttpServer server(service, policy,
                    {static_cast<std::size_t>(limits.slots + limits.line), limits.max_body, service.spool_folder()});
  const int port = server.bind(options.host, options.port);
  const std::string host = options.host.find(':') == std::string::npos ? options.host : "[" + options.host + "]";
  std::printf("listening on http://%s:%d\n", host.c_str(), port);
  std::fflush(stdout);
  log_event(LogLevel::info, "start",
            {{"version", TERRANE_VERSION},
             {"host", options.host},
             {"port", port},
             {"process", getpid()},
             {"threads", limits.slots},
             {"tokens", !options.token_file.empty()},
             {"workers_confined_to_folders", can_confine_files()}});

  Progress progress;
  std::thread guard;
  std::thread watcher([&] { watch_signals(server, service, progress, guard); });
  const bool clean = server.run();
  progress.finished = true;
  watcher.join();
  service.cancel();
  progress.stopped = true;
  if (guard.joinable()) guard.join();
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  log_event(clean ? LogLevel::info : LogLevel::error, "stop", {{"clean", clean}});
  if (!clean) throw Error(ErrorKind::internal, "socket-failed", "The listening socket failed.");
  return 0;
}

}  // namespace terrane
