// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace terrane {

/// Threads and two bounded lines in front of them. Short work is never kept waiting by long work: of the latter no more
/// is begun at the same time than leaves threads free.
class AnswerThreads {
 public:
  using Task = std::function<void()>;

  /// `long_tasks`: of them at the same time. `threads` has to be more.
  AnswerThreads(std::size_t threads, std::size_t long_tasks, std::size_t short_line, std::size_t long_line);
  /// What is in the lines is still done.
  ~AnswerThreads();
  AnswerThreads(const AnswerThreads&) = delete;
  AnswerThreads& operator=(const AnswerThreads&) = delete;

  /// False when the line is full. Tasks throw nothing.
  bool add_short(Task task);
  bool add_long(Task task);

 private:
  void work();

  const std::size_t long_tasks_, short_line_, long_line_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Task> short_, long_;
  std::size_t long_at_work_ = 0;
  bool closed_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace terrane
