// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/jobs/jobs.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>

#include "core/error.hpp"
#include "ops/errors.hpp"
#include "server/jobs/status_info.hpp"
#include "server/request_log.hpp"
#include "server/worker/worker_channel.hpp"

namespace terrane {

namespace fs = std::filesystem;

namespace {

using namespace std::chrono_literals;
constexpr auto house_step = 5s;
constexpr auto idle_step = 1s;  // other servers may have submitted
constexpr std::int64_t told_every_ms = 500, asked_every_ms = 700;
constexpr auto abandoned_after = 48h;  // folders of servers that never came back

/// Stages come one after another, each with a fraction of its own, and nobody knows how many there will be: every one
/// gets a part of what is left. Never falls, never reaches 100 before the end.
class Percent {
 public:
  int operator()(const std::string& stage, double fraction) {
    if (stage != stage_) base_ = now_, stage_ = stage;
    now_ = std::max(now_, base_ + (97 - base_) * 0.35 * std::clamp(fraction, 0.0, 1.0));
    return static_cast<int>(now_);
  }

 private:
  std::string stage_;
  double base_ = 0, now_ = 0;
};

}  // namespace

Instant Jobs::now() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

Jobs::Jobs(JobStore& store, const DataFolder& data, Workers& workers, Admission& admission,
           const References& references, const Outbound& outbound, const JobLimits& limits, std::string server,
           bool only_server)
    : store_(store),
      data_(data),
      workers_(workers),
      admission_(admission),
      references_(references),
      limits_(limits),
      server_(std::move(server)),
      only_server_(only_server),
      callbacks_(store, data, outbound) {
  remove_orphans();
  keep_house();
  for (int i = 0; i < limits_.runners; ++i) threads_.emplace_back([this] { run(); });
  threads_.emplace_back([this] {
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, house_step, [this] { return stopping_; })) {
      lock.unlock();
      keep_house();
      lock.lock();
    }
  });
}

/// What takes, ends, hands back or forgets jobs has to be written on a full disk too: for this the reserve is kept.
template <class Write>
auto Jobs::write_down(const Write& write) {
  try {
    return write();
  } catch (const std::exception&) {
    data_.release_reserve();
    return write();
  }
}

Jobs::~Jobs() { stop(); }

void Jobs::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_)
    if (thread.joinable()) thread.join();
  callbacks_.stop();
}

bool Jobs::has_room() { return store_.count()[static_cast<std::size_t>(JobStatus::accepted)] < limits_.max_waiting; }

Job Jobs::submit(Folder& folder, Job job) {
  if (!has_room())
    throw Error(ErrorKind::busy, "too-many-jobs", "Too many jobs wait already; send it again in a while.");
  job.created = job.updated = now();
  if (const auto before = add(folder, job)) return *before;
  {
    const std::lock_guard lock(mutex_);
    news_ = true;
  }
  wake_.notify_all();
  return job;
}

void Jobs::keep(Folder& folder, const Job& job) { add(folder, job); }

/// The folder has its lasting name before the record says that it is there.
std::optional<Job> Jobs::add(Folder& folder, const Job& job) {
  folder.become(data_.job(job.id));
  std::optional<Job> before;
  const auto remove = [&] {
    std::error_code ignored;
    fs::remove_all(data_.job(job.id), ignored);
  };
  try {
    before = store_.add(job);
  } catch (const Error& error) {
    // Any other failure may have come after the record was written, which must not be left without its folder.
    if (error.kind == ErrorKind::storage_full) remove();
    throw;
  }
  if (before) remove();
  return before;
}

JobPage Jobs::list(const JobFilter& filter) { return store_.list(filter, now()); }

std::optional<Job> Jobs::dismiss(const std::string& id) {
  auto job = store_.find(id);
  if (!job) return std::nullopt;
  if (is_over(job->status)) {
    forget(id);
    job->status = JobStatus::dismissed;
    return job;
  }
  job = write_down([&] { return store_.dismiss(id, now(), now() + limits_.expiry_ms); });
  const std::lock_guard lock(mutex_);
  if (const auto found = running_.find(id); found != running_.end()) *found->second = true;
  return job;
}

void Jobs::run() {
  while (true) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, idle_step, [this] { return stopping_ || news_; });
      if (stopping_) return;
      news_ = false;
    }
    // As long as there is something to do; a place is taken first, so that no job is taken that would only wait.
    while (true) {
      try {
        Context context;
        const Admission::Place place(admission_, context, Admission::Manner::patient);
        const auto job = write_down([&] { return store_.take(server_, now()); });
        if (!job) break;
        work(*job);
      } catch (const std::exception& exception) {
        if (as_error(exception).kind != ErrorKind::busy)  // else the service is closing
          log_event(LogLevel::error, std::string("the line of jobs: ") + exception.what());
        break;
      }
      const std::lock_guard lock(mutex_);
      if (stopping_) return;
    }
  }
}

void Jobs::work(const Job& job) {
  std::atomic<bool> dismissed = false;
  {
    const std::lock_guard lock(mutex_);
    running_[job.id] = &dismissed;
  }
  const std::shared_ptr<void> no_longer(nullptr, [&](void*) {
    const std::lock_guard lock(mutex_);
    running_.erase(job.id);
  });
  try {
    callbacks_.wake();
    const nlohmann::json outcome = perform(job, dismissed);
    finish({job, JobStatus::successful, "done", outcome});
  } catch (const std::exception& exception) {
    const nlohmann::json failure = failure_message(exception);
    if (dismissed) {
      // nobody waits for it
    } else if (as_error(exception).kind == ErrorKind::cancelled) {
      write_down([&] { return store_.hand_back(job.id, server_, now()); });
    } else {
      const bool ours = failure.value("kind", -1) == static_cast<int>(ErrorKind::internal);
      if (ours) log_event(LogLevel::error, "job " + job.id + ": " + exception.what());
      finish({job,
              JobStatus::failed,
              ours ? "Terrane failed on this job; that is a mistake of ours." : failure.at("message"),
              {{"failure", failure}}});
    }
  }
}

/// In a folder of this attempt's own: another server may think us lost and work on the same job.
nlohmann::json Jobs::perform(const Job& job, const std::atomic<bool>& dismissed) {
  data_.require_reserve();  // or its results would leave no room to say how it ended
  const fs::path lasting = data_.job(job.id);
  const Folder folder(data_.work(random_id()));
  for (const auto& entry : fs::directory_iterator(lasting))
    if (entry.is_regular_file()) fs::create_hard_link(entry.path(), folder.path() / entry.path().filename());

  Percent percent;
  Instant told = 0;
  Workers::Events events;
  bool lost = false;
  std::string stage_now = job.message;
  int percent_now = 0;
  // The store also says when the job is no longer ours. When it does not answer the work goes on.
  const auto write_progress = [&] {
    told = now();
    try {
      lost = !store_.progress(job.id, server_, percent_now, stage_now, now());
    } catch (const Error& error) {
      log_event(LogLevel::warning, "progress of job " + job.id + ": " + error.what());
    }
  };
  events.progress = [&](const std::string& stage, double fraction) {
    const int now_percent = percent(stage, fraction);
    if (now() - told < told_every_ms) return;
    stage_now = stage;
    percent_now = now_percent;
    write_progress();
  };
  events.is_unwanted = [&] {
    if (now() - told >= asked_every_ms) write_progress();
    const std::lock_guard lock(mutex_);
    return stopping_ || lost || dismissed;
  };
  const std::string base = base_of(data_, job);
  events.resolve = [&](const std::string& href) { return references_.resolve(folder.path(), base, href); };
  nlohmann::json outcome = workers_.run(Workers::What::perform, folder.path(), limits_.worker, limits_.seconds, events);

  // Results are complete and on stable storage before the record says so.
  const std::string name = "out-" + std::to_string(job.attempts);
  flush_folder(folder.path() / "out");
  rename_flushed(folder.path() / "out", lasting / name);
  outcome["folder"] = name;
  return outcome;
}

/// A job that is done stays ours until that is written down, however long the disk is full.
void Jobs::finish(const Ending& ending) {
  try {
    write_down([&] {
      return store_.finish(ending.job.id, server_, ending.status, ending.message, ending.outcome, now(),
                           now() + limits_.expiry_ms);
    });
  } catch (const std::exception& exception) {
    log_event(LogLevel::error, "the end of job " + ending.job.id + ": " + exception.what());
    const std::lock_guard lock(mutex_);
    unwritten_.push_back(ending);
  }
  callbacks_.wake();
}

void Jobs::keep_house() {
  try {
    // Alone, whatever others run is left from before. Among several, those are lost who have not been heard of; but a
    // server that was asleep itself hears of nobody, and waits until all had time to speak.
    const bool awake = now() - heard_ < limits_.lost_after_ms;
    if (!only_server_) fs::last_write_time(data_.work(), fs::file_time_type::clock::now());
    store_.heartbeat(server_, now());
    heard_ = now();
    const Instant lost_before = only_server_ ? std::numeric_limits<Instant>::max() : now() - limits_.lost_after_ms;
    const Error failure(ErrorKind::limit, "lost-too-often",
                        "The servers that worked on this job were lost " + std::to_string(limits_.max_attempts) +
                            " times; it is not tried again.");
    std::vector<Job> back;
    if (only_server_ || awake)
      back = store_.recover(server_, lost_before, limits_.max_attempts, failure.what(),
                            {{"failure", failure_message(failure)}}, now(), now() + limits_.expiry_ms);
    if (!back.empty()) {
      const std::lock_guard lock(mutex_);
      news_ = true;
    }
    std::vector<Ending> unwritten;
    {
      const std::lock_guard lock(mutex_);
      unwritten.swap(unwritten_);
    }
    for (const Ending& ending : unwritten) finish(ending);  // which throws nothing
    for (const std::string& id : store_.expired(now(), 100)) forget(id);
    data_.remove_older(data_.uploads(), std::chrono::milliseconds(limits_.expiry_ms));
    if (!only_server_) data_.remove_older(data_.root() / "work", abandoned_after);
    data_.take_reserve();
  } catch (const std::exception& exception) {
    log_event(LogLevel::error, std::string("keeping house: ") + exception.what());
  }
  wake_.notify_all();
}

/// The record goes first: a folder without one is an orphan, a record without a folder would be a lie.
void Jobs::forget(const std::string& id) {
  write_down([&] { store_.remove(id); });
  std::error_code ignored;
  fs::remove_all(data_.job(id), ignored);
}

/// What a kill left between a folder's name and its record.
void Jobs::remove_orphans() {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(data_.root() / "jobs", error)) {
    // Beside other servers a young one may be about to get its record.
    if (!only_server_ && fs::file_time_type::clock::now() - entry.last_write_time(error) < abandoned_after) continue;
    if (!is_id(entry.path().filename().string()) || !store_.find(entry.path().filename().string())) {
      std::error_code ignored;
      fs::remove_all(entry.path(), ignored);
    }
  }
}

}  // namespace terrane
