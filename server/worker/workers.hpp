// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/worker/perform.hpp"
#include "server/worker/sandbox.hpp"

// Executions in processes of their own: a crash, a leak or a hang of one is a failed job, and the service lives.
//
// One process that has loaded everything is started with the service; for each order it forks, which takes a
// millisecond. A worker talks to the service in lines of JSON over a socket of its own; it dies when the service lets
// go of its leash, a pipe, so also when the service is killed.
namespace terrane {

class Workers {
 public:
  /// `command`: what starts the maker of workers; the number of its socket is added. `place`: the folder that all
  /// folders of executions lie in, directly. Whoever workers are, they need no right to the folders above.
  Workers(std::vector<std::string> command, std::filesystem::path place);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  enum class What { check, perform };
  struct Events {
    std::function<void(const std::string& stage, double fraction)> progress = {};
    Resolve resolve = {};
    std::function<bool()> is_unwanted = {};  // asked ten times a second; true: the worker is killed
  };

  /// Runs check_order or perform on the folder in a worker and returns what it returns. Blocks. Throws what that
  /// throws; Error{cancelled} when it was unwanted, Error{limit} "too-slow" | "out-of-memory" when a limit stopped it,
  /// and Error{internal} "worker-died" when it crashed. From any thread.
  nlohmann::json run(What what, const std::filesystem::path& folder, const WorkerLimits& limits, double seconds,
                     const Events& events);

 private:
  int socket();
  void start();

  const std::vector<std::string> command_;
  const std::filesystem::path place_;
  std::mutex mutex_;
  int socket_ = -1;
};

}  // namespace terrane
