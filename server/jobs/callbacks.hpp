// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "server/data_folder.hpp"
#include "server/jobs/job_store.hpp"
#include "server/requests/outbound.hpp"

namespace terrane {

/// Tells subscribers that their jobs began and how they ended, on threads of its own: no work waits for a subscriber.
/// What is still to tell stands in the store, so a stop or a kill loses none of it; the same may be told twice. An end
/// is told again until it is taken, refused (4xx), or was told seven times within a quarter of an hour; a beginning
/// once.
class Callbacks {
 public:
  /// The rest must outlive it.
  Callbacks(JobStore& store, const DataFolder& data, const Outbound& outbound);
  /// As stop().
  ~Callbacks();
  Callbacks(const Callbacks&) = delete;
  Callbacks& operator=(const Callbacks&) = delete;

  /// There may be something to tell.
  void wake();
  /// Returns when nobody is told any more. Quick when `outbound` was stopped.
  void stop();

 private:
  void run();
  std::chrono::milliseconds tell_one();
  void tell(const Job& job);
  Outbound::Answer tell_beginning(const Job& job) const;
  Outbound::Answer tell_end(const Job& job) const;
  Outbound::Answer post(const Job& job, const char* event, const std::string& media_type,
                        const std::string& body) const;

  JobStore& store_;
  const DataFolder& data_;
  const Outbound& outbound_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false, news_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace terrane
