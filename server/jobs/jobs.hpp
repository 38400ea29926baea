// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/admission.hpp"
#include "server/data_folder.hpp"
#include "server/jobs/callbacks.hpp"
#include "server/jobs/job_store.hpp"
#include "server/jobs/references.hpp"
#include "server/worker/workers.hpp"

namespace terrane {

struct JobLimits {
  WorkerLimits worker;
  double seconds = 3600;                // of one attempt
  std::int64_t expiry_ms = 86'400'000;  // how long a job that is over is kept
  std::size_t max_waiting = 1000;       // accepted and not begun
  int runners = 1;
  int max_attempts = 100;               // by servers that were lost meanwhile: not its fault, but no end either
  std::int64_t lost_after_ms = 30'000;  // without a sign of life
};

/// The line of jobs and those who work on it: submitted, taken, done in a worker, kept for a while, forgotten. Whatever
/// was acknowledged survives a kill at any moment; see JobStore.
class Jobs {
 public:
  /// `only_server`: nobody else uses the store, so that whatever runs in it is left from before. The rest must outlive
  /// it.
  Jobs(JobStore& store, const DataFolder& data, Workers& workers, Admission& admission, const References& references,
       const Outbound& outbound, const JobLimits& limits, std::string server, bool only_server);
  /// As stop().
  ~Jobs();

  /// Acknowledges a job whose folder holds all that it needs (call.json, body, references), which becomes the job's.
  /// When its idempotency key is known already, the job of that key is returned instead. Throws Error{busy} when too
  /// many wait.
  Job submit(Folder& folder, Job job);
  /// Keeps a job that is over already, with its results in the folder.
  void keep(Folder& folder, const Job& job);
  std::optional<Job> find(const std::string& id) { return store_.find(id); }
  JobPage list(const JobFilter& filter);
  /// An accepted or running job stops within a second. A job that is over is forgotten, with its results.
  std::optional<Job> dismiss(const std::string& id);
  std::vector<std::size_t> count() { return store_.count(); }
  bool has_room();

  /// Nothing more is taken; what runs is handed back, for the next server or the next start. Returns when that is done.
  void stop();

  static Instant now();

 private:
  std::optional<Job> add(Folder& folder, const Job& job);
  void run();
  void work(const Job& job);
  nlohmann::json perform(const Job& job, const std::atomic<bool>& dismissed);
  /// How a job of ours ended.
  struct Ending {
    Job job;
    JobStatus status;
    std::string message;
    nlohmann::json outcome;
  };
  void finish(const Ending& ending);
  template <class Write>
  auto write_down(const Write& write);
  void keep_house();
  void forget(const std::string& id);
  void remove_orphans();

  JobStore& store_;
  const DataFolder& data_;
  Workers& workers_;
  Admission& admission_;
  const References& references_;
  const JobLimits limits_;
  const std::string server_;
  const bool only_server_;

  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false, news_ = false;
  Instant heard_ = 0;                                  // when the store last took our sign of life
  std::map<std::string, std::atomic<bool>*> running_;  // here, and whether it was dismissed
  std::vector<Ending> unwritten_;                      // that the store did not take
  Callbacks callbacks_;
  std::vector<std::thread> threads_;
};

}  // namespace terrane
