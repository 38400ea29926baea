// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/answer_threads.hpp"

namespace terrane {

AnswerThreads::AnswerThreads(std::size_t threads, std::size_t long_tasks, std::size_t short_line, std::size_t long_line)
    : long_tasks_(long_tasks), short_line_(short_line), long_line_(long_line) {
  for (std::size_t i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
}

AnswerThreads::~AnswerThreads() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

bool AnswerThreads::add_short(Task task) {
  {
    const std::lock_guard lock(mutex_);
    if (short_.size() >= short_line_) return false;
    short_.push_back(std::move(task));
  }
  wake_.notify_one();
  return true;
}

bool AnswerThreads::add_long(Task task) {
  {
    const std::lock_guard lock(mutex_);
    if (long_.size() >= long_line_) return false;
    long_.push_back(std::move(task));
  }
  wake_.notify_one();
  return true;
}

void AnswerThreads::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    const auto may_begin_long = [&] { return !long_.empty() && long_at_work_ < long_tasks_; };
    wake_.wait(lock, [&] { return !short_.empty() || may_begin_long() || (closed_ && long_.empty()); });
    if (short_.empty() && !may_begin_long()) return;
    const bool is_long = short_.empty();
    std::deque<Task>& line = is_long ? long_ : short_;
    Task task = std::move(line.front());
    line.pop_front();
    long_at_work_ += is_long;
    if (closed_) wake_.notify_all();  // those that wait for the end of the line
    lock.unlock();
    task();
    task = nullptr;
    lock.lock();
    long_at_work_ -= is_long;
    // Whoever was woken for it found no place then, and we may be taken by short work now.
    if (may_begin_long()) wake_.notify_one();
  }
}

}  // namespace terrane
