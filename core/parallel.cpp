// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/parallel.hpp"

#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "core/error.hpp"

namespace terrane {

namespace {

class Work {
 public:
  Work(const Context& context, std::size_t count, const std::function<void(std::size_t)>& task)
      : context_(context), count_(count), task_(task) {}

  /// Takes tasks until none is left.
  void take() noexcept {
    for (;;) {
      const std::size_t i = next_++;
      if (i >= count_) return;
      try {
        if (context_.cancelled.load(std::memory_order_relaxed)) {
          throw Error(ErrorKind::cancelled, "cancelled", "cancelled");
        }
        task_(i);
      } catch (...) {
        fail(i);
        return;
      }
    }
  }

  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  /// Every task before i has begun and will end by itself, so the one kept does
  /// not depend on who was faster.
  void fail(std::size_t i) {
    next_ = count_;
    const std::lock_guard lock(mutex_);
    if (!failure_ || i < failed_) {
      failure_ = std::current_exception();
      failed_ = i;
    }
  }

  const Context& context_;
  const std::size_t count_;
  const std::function<void(std::size_t)>& task_;
  std::atomic<std::size_t> next_ = 0;
  std::mutex mutex_;
  std::exception_ptr failure_;
  std::size_t failed_ = 0;
};

}  // namespace

void parallel_tasks(const Context& context, std::size_t count, const std::function<void(std::size_t)>& task) {
  Work work(context, count, task);
  std::vector<std::thread> helpers;
  const std::size_t threads = std::min<std::size_t>(std::max(context.threads, 1), count);
  try {
    while (helpers.size() + 1 < threads) helpers.emplace_back([&work] { work.take(); });
  } catch (const std::system_error &) {
    // A machine that gives no more threads: those there are do the work.
  }
  work.take();
  for (std::thread &helper : helpers) helper.join();
  work.rethrow();
}

}  // namespace terrane
