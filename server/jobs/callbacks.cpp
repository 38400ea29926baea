// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/jobs/callbacks.hpp"

#include <algorithm>
#include <cmath>

#include "ops/json_value.hpp"
#include "server/http/open_file.hpp"
#include "server/jobs/jobs.hpp"
#include "server/jobs/status_info.hpp"
#include "server/request_log.hpp"

namespace terrane {

namespace {

using namespace std::chrono_literals;
using Answer = Outbound::Answer;

constexpr int callback_threads = 2;
constexpr auto idle_step = 1s, pause_after_failure = 5s;
constexpr std::int64_t lease_ms = 30'000;  // more than telling takes
constexpr int most_tellings = 7;
constexpr std::uint64_t largest_callback = 64 << 20;

/// 1, 5, 25, 125, 625 seconds; the first telling may have been of the beginning alone.
std::int64_t pause_ms(int tellings) { return static_cast<std::int64_t>(1000 * std::pow(5, std::max(0, tellings - 2))); }

}  // namespace

Callbacks::Callbacks(JobStore& store, const DataFolder& data, const Outbound& outbound)
    : store_(store), data_(data), outbound_(outbound) {
  for (int i = 0; i < callback_threads; ++i) threads_.emplace_back([this] { run(); });
}

Callbacks::~Callbacks() { stop(); }

void Callbacks::wake() {
  {
    const std::lock_guard lock(mutex_);
    news_ = true;
  }
  wake_.notify_one();
}

void Callbacks::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_)
    if (thread.joinable()) thread.join();
}

void Callbacks::run() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    news_ = false;
    lock.unlock();
    const auto pause = tell_one();
    lock.lock();
    wake_.wait_for(lock, pause, [this] { return stopping_ || news_; });
  }
}

/// How long there is nothing to do.
std::chrono::milliseconds Callbacks::tell_one() {
  try {
    const auto job = store_.untold(Jobs::now(), Jobs::now() + lease_ms);
    if (!job) return idle_step;
    tell(*job);
    return 0ms;
  } catch (const std::exception& exception) {
    log_event(LogLevel::error, std::string("callbacks: ") + exception.what());
    return pause_after_failure;
  }
}

void Callbacks::tell(const Job& job) {
  Answer answer = Answer::taken;
  try {
    if (job.tellings == 1) answer = tell_beginning(job);
    if (is_over(job.status)) answer = tell_end(job);
  } catch (const std::exception& exception) {
    log_event(LogLevel::warning, "telling of job " + job.id + ": " + exception.what());
    answer = Answer::none;
  }
  if (answer == Answer::none && is_over(job.status) && job.tellings < most_tellings)
    return store_.tell_again(job.id, Jobs::now() + pause_ms(job.tellings));
  if (answer != Answer::taken)
    log_event(LogLevel::warning,
              "job " + job.id + ": its subscriber did not take that it is " + std::string(word(job.status)));
  store_.told(job.id, job.status, Jobs::now());
}

/// As it was then, also when it is over by now.
Answer Callbacks::tell_beginning(const Job& job) const {
  Job then = job;
  then.status = JobStatus::running;
  then.message.clear();
  then.progress = 0;
  then.updated = job.started.value_or(job.updated);
  then.finished = then.expires = std::nullopt;
  return post(job, "inProgressUri", "application/json", json_text(status_info(then, base_of(data_, job))));
}

Answer Callbacks::tell_end(const Job& job) const {
  const std::string status = json_text(status_info(job, base_of(data_, job)));
  if (job.status != JobStatus::successful) return post(job, "failedUri", "application/json", status);
  const nlohmann::json& reply = job.outcome.at("reply");
  if (const std::string file = reply.value("file", ""); !file.empty()) {
    const OpenFile result(data_.job(job.id) / job.outcome.at("folder").get<std::string>() / file);
    if (result.size() <= largest_callback) return post(job, "successUri", reply.value("media_type", ""), result.text());
  }
  return post(job, "successUri", "application/json", status);
}

/// Who did not ask for an event has taken it.
Answer Callbacks::post(const Job& job, const char* event, const std::string& media_type,
                       const std::string& body) const {
  const std::string uri = job.subscriber.is_object() ? job.subscriber.value(event, "") : "";
  return uri.empty() ? Answer::taken : outbound_.post(uri, media_type, body);
}

}  // namespace terrane
