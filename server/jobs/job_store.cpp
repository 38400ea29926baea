// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/jobs/job_store.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <mutex>
#include <random>

#include "core/error.hpp"
#include "ops/json_value.hpp"
#include "server/jobs/sql_database.hpp"

namespace terrane {

namespace {

constexpr std::array<std::string_view, 5> status_words = {"accepted", "running", "successful", "failed", "dismissed"};

const std::string columns =
    "id, operation, status, message, progress, created, updated, started, finished, expires, attempts, owner, "
    "idempotency_key, fingerprint, subscriber, outcome, tellings";

/// PostgreSQL refuses text that is not UTF-8 or holds a zero, and a message may quote what a client sent.
std::string clean(std::string text) {
  if (std::all_of(text.begin(), text.end(), [](char c) { return c > 0; })) return text;
  text = utf8_text(text);
  std::erase(text, '\0');
  return text;
}

SqlValue json_value(const nlohmann::json& json) {
  if (json.is_null()) return std::monostate();
  return json_text(json);
}

std::int64_t bounded(std::size_t n) {
  return static_cast<std::int64_t>(std::min<std::size_t>(n, std::numeric_limits<std::int64_t>::max()));
}

Job job_of(const SqlRow& row) {
  const auto text = [&](std::size_t column) { return row.at(column).value_or(""); };
  const auto number = [&](std::size_t column) { return std::stoll(row.at(column).value()); };
  const auto instant = [&](std::size_t column) {
    return row.at(column) ? std::optional<Instant>(number(column)) : std::nullopt;
  };
  const auto json = [&](std::size_t column) {
    return row.at(column) ? nlohmann::json::parse(*row[column]) : nlohmann::json();
  };
  try {
    Job job;
    job.id = text(0);
    job.operation = text(1);
    job.status = job_status(text(2)).value();
    job.message = text(3);
    job.progress = static_cast<int>(number(4));
    job.created = number(5);
    job.updated = number(6);
    job.started = instant(7);
    job.finished = instant(8);
    job.expires = instant(9);
    job.attempts = static_cast<int>(number(10));
    if (job.status == JobStatus::running) job.owner = text(11);
    job.idempotency_key = text(12);
    job.fingerprint = text(13);
    job.subscriber = json(14);
    job.outcome = json(15);
    job.tellings = static_cast<int>(number(16));
    return job;
  } catch (const std::exception& exception) {
    fail_store("a record of a job cannot be understood: " + std::string(exception.what()));
  }
}

std::optional<Job> first(const std::vector<SqlRow>& rows) {
  return rows.empty() ? std::nullopt : std::optional(job_of(rows.front()));
}

SqlValue value(const std::optional<Instant>& instant) { return instant ? SqlValue(*instant) : SqlValue(); }

std::string random_name() {
  std::random_device random;
  std::string name;
  for (int i = 0; i < 4; ++i) name += std::to_string(random()) + '-';
  return name;
}

/// Every function but `add`, `list` and a `dismiss` in vain is one statement, so nothing is ever half done.
class SqlJobStore : public JobStore {
 public:
  SqlJobStore(std::shared_ptr<SqlDatabase> database, std::shared_ptr<SqlDatabase> reader, std::string_view skip_locked)
      : database_(std::move(database)), reader_(std::move(reader)), skip_locked_(skip_locked), name_(random_name()) {}

  std::optional<Job> add(const Job& job) override {
    const SqlValue key = job.idempotency_key.empty() ? SqlValue() : clean(job.idempotency_key);
    // Whoever holds the key may be forgotten between the two statements, but hardly three times in a row.
    for (int i = 0; i < 3; ++i) {
      const auto added = database_->run(
          "INSERT INTO terrane_jobs (id, operation, status, message, progress, created, updated, idempotency_key, "
          "fingerprint, subscriber, started, finished, expires, attempts, outcome) VALUES "
          "($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15) ON CONFLICT DO NOTHING RETURNING id",
          {clean(job.id), clean(job.operation), std::string(word(job.status)), clean(job.message),
           percent(job.progress), job.created, job.updated, key, clean(job.fingerprint), json_value(job.subscriber),
           value(job.started), value(job.finished), value(job.expires), std::int64_t{job.attempts},
           json_value(job.outcome)});
      if (!added.empty()) return std::nullopt;
      const auto holder = first(database_->run(
          "SELECT " + columns + " FROM terrane_jobs WHERE id = $1 OR idempotency_key = $2 ORDER BY id <> $1 LIMIT 1",
          {clean(job.id), key}));
      // Its own id there already: it was added when the answer was lost.
      if (holder) return holder->id == job.id ? std::nullopt : holder;
    }
    fail_store("a job could not be added");
  }

  std::optional<Job> find(const std::string& id) override {
    return first(reader_->run("SELECT " + columns + " FROM terrane_jobs WHERE id = $1", {clean(id)}));
  }

  JobPage list(const JobFilter& filter, Instant now) override {
    std::vector<SqlValue> values;
    std::string conditions = " WHERE true";
    const auto parameter = [&](SqlValue value) {
      values.push_back(std::move(value));
      return '$' + std::to_string(values.size());
    };
    const auto any_of = [&](const std::string& column, const auto& wanted, const auto& text) {
      std::string list;
      for (const auto& one : wanted) list += (list.empty() ? "" : ", ") + parameter(text(one));
      if (!list.empty()) conditions += " AND " + column + " IN (" + list + ")";
    };
    const auto compare = [&](const std::string& what, const std::optional<std::int64_t>& limit) {
      if (limit) conditions += " AND " + what + parameter(*limit);
    };
    any_of("operation", filter.operations, [](const std::string& operation) { return clean(operation); });
    any_of("status", filter.statuses, [](JobStatus status) { return std::string(word(status)); });
    compare("created >= ", filter.created_from);
    compare("created <= ", filter.created_until);
    if (filter.min_duration || filter.max_duration) {
      const std::string duration = "coalesce(finished, " + parameter(now) + ") - started";
      compare(duration + " >= ", filter.min_duration);
      compare(duration + " <= ", filter.max_duration);
    }
    JobPage page;
    page.matched =
        std::stoull(reader_->run("SELECT count(*) FROM terrane_jobs" + conditions, values).at(0).at(0).value());
    const std::string limit = parameter(bounded(filter.limit)), offset = parameter(bounded(filter.offset));
    for (const auto& row : reader_->run("SELECT " + columns + " FROM terrane_jobs" + conditions +
                                            " ORDER BY created DESC, id LIMIT " + limit + " OFFSET " + offset,
                                        values)) {
      page.jobs.push_back(job_of(row));
    }
    // Jobs may have come between the two statements.
    if (!page.jobs.empty()) page.matched = std::max(page.matched, filter.offset + page.jobs.size());
    return page;
  }

  std::vector<std::size_t> count() override {
    std::vector<std::size_t> counts(status_words.size());
    for (const auto& row : reader_->run("SELECT status, count(*) FROM terrane_jobs GROUP BY status", {})) {
      const auto status = job_status(row.at(0).value());
      if (status) counts[static_cast<std::size_t>(*status)] = std::stoull(row.at(1).value());
    }
    return counts;
  }

  std::optional<Job> take(const std::string& server, Instant now) override {
    // Were the answer lost, the job would run for ever and nobody would work on it. So every taking has a name of its
    // own, which is kept until a job has come with it, and a job that has it already is the answer.
    const std::lock_guard lock(taking_);
    auto job = first(database_->run(
        "UPDATE terrane_jobs SET status = 'running', message = 'started', owner = $1, claim = $2, started = $3, "
        "updated = $3, heard = $3, "
        "tellings = 0, tell_at = CASE WHEN subscriber IS NULL THEN NULL ELSE $3 END, "
        "attempts = attempts + CASE WHEN status = 'accepted' THEN 1 ELSE 0 END WHERE number = coalesce("
        "(SELECT number FROM terrane_jobs WHERE claim = $2 AND status = 'running'), "
        "(SELECT number FROM terrane_jobs WHERE status = 'accepted' ORDER BY number LIMIT 1" +
            skip_locked_ +
            ")) "
            "AND status IN ('accepted', 'running') RETURNING " +
            columns,
        {clean(server), name_ + std::to_string(taken_), now}));
    if (job) ++taken_;
    return job;
  }

  bool progress(const std::string& id, const std::string& owner, int done, const std::string& message,
                Instant now) override {
    return changed(
        "UPDATE terrane_jobs SET progress = CASE WHEN progress < $3 THEN $3 ELSE progress END, message = $4, updated = "
        "$5 "
        "WHERE id = $1 AND owner = $2 AND status = 'running' RETURNING id",
        {clean(id), clean(owner), percent(done), clean(message), now}, Durability::soon);
  }

  bool finish(const std::string& id, const std::string& owner, JobStatus status, const std::string& message,
              const nlohmann::json& outcome, Instant now, Instant expires) override {
    // Owner and claim stay, so that the same once more is known as the same.
    return changed(
        "UPDATE terrane_jobs SET status = $3, message = $4, outcome = $5, updated = $6, finished = $6, expires = $7, "
        "tell_at = CASE WHEN subscriber IS NULL THEN NULL ELSE coalesce(tell_at, $6) END, "
        "progress = CASE WHEN $3 = 'successful' THEN 100 ELSE progress END WHERE id = $1 AND owner = $2 "
        "AND (status = 'running' OR (status = $3 AND finished = $6)) RETURNING id",
        {clean(id), clean(owner), std::string(word(status)), clean(message), json_value(outcome), now, expires});
  }

  bool hand_back(const std::string& id, const std::string& owner, Instant now) override {
    return changed(
        "UPDATE terrane_jobs SET status = 'accepted', message = '', progress = 0, updated = $3, started = NULL, "
        "owner = '', claim = NULL, tell_at = NULL WHERE id = $1 AND owner = $2 AND status = 'running' RETURNING id",
        {clean(id), clean(owner), now});
  }

  std::optional<Job> dismiss(const std::string& id, Instant now, Instant expires) override {
    const auto job = first(database_->run(
        "UPDATE terrane_jobs SET status = 'dismissed', updated = $2, finished = $2, expires = $3, owner = '', "
        "claim = NULL, tell_at = NULL WHERE id = $1 AND status IN ('accepted', 'running') RETURNING " +
            columns,
        {clean(id), now, expires}));
    return job ? job : find(id);
  }

  void heartbeat(const std::string& server, Instant now) override {
    // It is kept with the jobs that depend on it: a server without jobs has none to lose.
    database_->run("UPDATE terrane_jobs SET heard = $2 WHERE owner = $1 AND status = 'running'", {clean(server), now});
  }

  std::vector<Job> recover(const std::string& server, Instant lost_before, int max_attempts, const std::string& message,
                           const nlohmann::json& outcome, Instant now, Instant expires) override {
    const auto unless_tired = [](const std::string& then, const std::string& otherwise) {
      return "CASE WHEN attempts < $2 THEN " + then + " ELSE " + otherwise + " END";
    };
    std::vector<Job> jobs;
    for (const auto& row : database_->run(
             "UPDATE terrane_jobs SET status = " + unless_tired("'accepted'", "'failed'") +
                 ", message = " + unless_tired("''", "$3") + ", progress = " + unless_tired("0", "progress") +
                 ", outcome = " + unless_tired("NULL", "$4") +
                 ", updated = $5, started = " + unless_tired("NULL", "started") +
                 ", finished = " + unless_tired("NULL", "$5") + ", expires = " + unless_tired("NULL", "$6") +
                 ", tell_at = " + unless_tired("NULL", "CASE WHEN subscriber IS NULL THEN NULL ELSE $5 END") +
                 ", owner = '', claim = NULL WHERE number IN (SELECT number FROM terrane_jobs WHERE status = 'running' "
                 "AND heard < $1 AND owner <> $7 ORDER BY number" +
                 skip_locked_ + ") RETURNING " + columns,
             {lost_before, std::int64_t{max_attempts}, clean(message), json_value(outcome), now, expires,
              clean(server)})) {
      jobs.push_back(job_of(row));
    }
    return jobs;
  }

  std::optional<Job> untold(Instant now, Instant until) override {
    // Were the answer lost, it is told later.
    return first(database_->run(
        "UPDATE terrane_jobs SET tellings = tellings + 1, tell_at = $2 WHERE number = (SELECT number FROM terrane_jobs "
        "WHERE tell_at <= $1 ORDER BY tell_at LIMIT 1" +
            skip_locked_ + ") RETURNING " + columns,
        {now, until}));
  }

  void told(const std::string& id, JobStatus status, Instant now) override {
    database_->run(
        "UPDATE terrane_jobs SET tell_at = CASE WHEN status = $2 THEN NULL ELSE $3 END "
        "WHERE id = $1 AND tell_at IS NOT NULL",
        {clean(id), std::string(word(status)), now});
  }

  void tell_again(const std::string& id, Instant when) override {
    database_->run("UPDATE terrane_jobs SET tell_at = $2 WHERE id = $1 AND tell_at IS NOT NULL", {clean(id), when});
  }

  std::vector<std::string> expired(Instant now, std::size_t limit) override {
    std::vector<std::string> ids;
    for (auto& row : reader_->run("SELECT id FROM terrane_jobs WHERE expires <= $1 ORDER BY expires, number LIMIT $2",
                                  {now, bounded(limit)})) {
      ids.push_back(std::move(row.at(0).value()));
    }
    return ids;
  }

  void remove(const std::string& id) override {
    database_->run("DELETE FROM terrane_jobs WHERE id = $1 AND status NOT IN ('accepted', 'running')", {clean(id)});
  }

 private:
  static std::int64_t percent(int progress) { return std::clamp(progress, 0, 100); }
  bool changed(const std::string& sql, const std::vector<SqlValue>& values, Durability durability = Durability::now) {
    return !database_->run(sql, values, durability).empty();
  }

  const std::shared_ptr<SqlDatabase> database_, reader_;
  const std::string skip_locked_, name_;
  std::mutex taking_;
  std::uint64_t taken_ = 0;
};

}  // namespace

std::string_view word(JobStatus status) { return status_words.at(static_cast<std::size_t>(status)); }

std::optional<JobStatus> job_status(std::string_view word) {
  const auto found = std::find(status_words.begin(), status_words.end(), word);
  if (found == status_words.end()) return std::nullopt;
  return static_cast<JobStatus>(found - status_words.begin());
}

std::string job_schema(int from, std::string_view number) {
  const std::string first =
      "CREATE TABLE terrane_jobs (number " + std::string(number) +
      ", id text NOT NULL UNIQUE, operation text NOT NULL, status text NOT NULL, message text NOT NULL, "
      "progress bigint NOT NULL, created bigint NOT NULL, updated bigint NOT NULL, started bigint, finished bigint, "
      "expires bigint, attempts bigint NOT NULL DEFAULT 0, owner text NOT NULL DEFAULT '', claim text UNIQUE, "
      "heard bigint, idempotency_key text UNIQUE, fingerprint text NOT NULL, subscriber text, outcome text);"
      "CREATE INDEX terrane_jobs_line ON terrane_jobs (status, number);"
      "CREATE INDEX terrane_jobs_list ON terrane_jobs (created DESC, id);"
      "CREATE INDEX terrane_jobs_expires ON terrane_jobs (expires);";
  // When the subscriber is to hear of it, and how often that was tried.
  const std::string second =
      "ALTER TABLE terrane_jobs ADD COLUMN tell_at bigint;"
      "ALTER TABLE terrane_jobs ADD COLUMN tellings bigint NOT NULL DEFAULT 0;"
      "CREATE INDEX terrane_jobs_tell ON terrane_jobs (tell_at);";
  return (from < 1 ? first : "") + (from < 2 ? second : "");
}

std::unique_ptr<JobStore> make_job_store(std::shared_ptr<SqlDatabase> database, std::shared_ptr<SqlDatabase> reader,
                                         std::string_view skip_locked) {
  return std::make_unique<SqlJobStore>(std::move(database), std::move(reader), skip_locked);
}

void fail_store(const std::string& what) {
  throw Error(ErrorKind::internal, "store-failed", "the store of jobs: " + what);
}

void fail_store_full(const std::string& what) {
  throw Error(ErrorKind::storage_full, "storage-full", "the store of jobs has no room left: " + what);
}

}  // namespace terrane
