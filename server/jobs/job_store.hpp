// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// What is known of jobs, where a kill at any moment loses none that was acknowledged. The bytes of requests and results
// are files; here are the records alone.
namespace terrane {

/// OGC API - Processes 1.0, statusCode.
enum class JobStatus { accepted, running, successful, failed, dismissed };
std::string_view word(JobStatus status);
/// Nothing for any other word.
std::optional<JobStatus> job_status(std::string_view word);
inline bool is_over(JobStatus status) { return status != JobStatus::accepted && status != JobStatus::running; }

/// Milliseconds since 1970, UTC.
using Instant = std::int64_t;

struct Job {
  std::string id;         // 32 hexadecimal digits, made by whoever submits
  std::string operation;  // process id
  JobStatus status = JobStatus::accepted;
  std::string message;  // the stage of the work, or why it failed
  int progress = 0;     // 0 to 100, never falls while it runs
  Instant created = 0, updated = 0;
  std::optional<Instant> started, finished;
  std::optional<Instant> expires;  // from when on it may be forgotten; set when it is over
  int attempts = 0;                // how often somebody took it
  std::string owner;               // the server that took it, while it runs
  std::string idempotency_key;     // of the client, or empty
  std::string fingerprint;         // of the request that the key stands for
  nlohmann::json subscriber;       // the URIs of a subscriber, or null
  int tellings = 0;                // how often its subscriber was to hear of it
  nlohmann::json outcome;  // of a job that is over: what its results are, or the problem it failed with; or null
};

/// Which jobs a list shows: all that fit every condition, the latest created first, ties by id.
struct JobFilter {
  std::vector<std::string> operations;                     // any of them; empty: all
  std::vector<JobStatus> statuses;                         // likewise
  std::optional<Instant> created_from, created_until;      // both ends included
  std::optional<std::int64_t> min_duration, max_duration;  // milliseconds from start to end, or to `now` while it runs
  std::size_t offset = 0, limit = 10;
};

struct JobPage {
  std::vector<Job> jobs;
  std::size_t matched = 0;  // without the limit
};

/// Records on stable storage: what a function has done when it returns survives any kill and any loss of power. Safe to
/// use from several threads, and the PostgreSQL one from several servers. Throws Error{storage_full} "storage-full"
/// when there is no room left, Error{internal} "store-failed" when the store cannot be reached or is broken.
class JobStore {
 public:
  virtual ~JobStore() = default;

  /// Adds a job as it is: `accepted`, or over already. When there is one with its (not empty) idempotency key already,
  /// that one is returned and nothing is added. One of two that come at the same time wins. A job whose id is there
  /// already is not added again, so whoever got no answer can ask once more.
  virtual std::optional<Job> add(const Job& job) = 0;

  virtual std::optional<Job> find(const std::string& id) = 0;
  virtual JobPage list(const JobFilter& filter, Instant now) = 0;
  /// How many there are of each status, in the order of the enum.
  virtual std::vector<std::size_t> count() = 0;

  /// The job accepted first becomes `running`, owned by `server`; nothing when there is none. No job is ever taken by
  /// two.
  virtual std::optional<Job> take(const std::string& server, Instant now) = 0;
  /// Progress of a job that `owner` runs; false when it is no longer theirs (dismissed, or handed to another). Need not
  /// be on stable storage.
  virtual bool progress(const std::string& id, const std::string& owner, int percent, const std::string& message,
                        Instant now) = 0;
  /// The end of a job that `owner` runs: successful (its progress is 100 then) or failed; false when it is no longer
  /// theirs. Whoever got no answer can ask once more with the same status and `now`, and learns that it is done.
  virtual bool finish(const std::string& id, const std::string& owner, JobStatus status, const std::string& message,
                      const nlohmann::json& outcome, Instant now, Instant expires) = 0;
  /// A job back in the line with the place it had, because its server stops; false when it is no longer theirs.
  virtual bool hand_back(const std::string& id, const std::string& owner, Instant now) = 0;
  /// A job that is accepted or running becomes dismissed. Nothing when there is no such job; else as it is now,
  /// unchanged when it was over already.
  virtual std::optional<Job> dismiss(const std::string& id, Instant now, Instant expires) = 0;

  /// Says that a server is alive. A server that has not said so since before `lost_before` is lost.
  virtual void heartbeat(const std::string& server, Instant now) = 0;
  /// Running jobs of lost servers other than `server` go back in the line with their place, those that were taken
  /// `max_attempts` times fail with `message` and `outcome` instead. Returns all of them as they are now. Whoever of
  /// several servers asks first gets them.
  virtual std::vector<Job> recover(const std::string& server, Instant lost_before, int max_attempts,
                                   const std::string& message, const nlohmann::json& outcome, Instant now,
                                   Instant expires) = 0;

  /// A job that was taken or is over and whose subscriber does not know, the one that waits for longest; nothing when
  /// there is none. Nobody else gets it before `until`, from when on it counts as not told.
  virtual std::optional<Job> untold(Instant now, Instant until) = 0;
  /// The subscriber knows of that status, or never will. When it is another by now, of that there is to tell.
  virtual void told(const std::string& id, JobStatus status, Instant now) = 0;
  /// It is to be told at that time.
  virtual void tell_again(const std::string& id, Instant when) = 0;

  /// Ids of jobs whose `expires` has passed, the oldest first.
  virtual std::vector<std::string> expired(Instant now, std::size_t limit) = 0;
  /// Forgets a job that is over.
  virtual void remove(const std::string& id) = 0;
};

/// SQLite in one file (WAL, synchronous=FULL), made when it is not there, for one server. "" keeps it in memory.
std::unique_ptr<JobStore> open_sqlite_store(const std::string& file);
/// PostgreSQL at postgresql://..., for any number of servers; its one table is made when it is not there.
std::unique_ptr<JobStore> open_postgresql_store(const std::string& uri);

}  // namespace terrane
