// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "core/error.hpp"

using namespace terrane;

TEST(Parallel, EveryNumberOnceInRangesThatDoNotDependOnThreads) {
  for (const int threads : {0, 1, 2, 3, 8}) {
    for (const std::size_t count : {0, 1, 6, 7, 8, 1000}) {
      Context context;
      context.threads = threads;
      std::vector<std::atomic<int>> seen(count);
      std::vector<std::atomic<std::size_t>> length((count + 6) / 7);
      parallel_for(context, count, 7, [&](std::size_t first, std::size_t last) {
        EXPECT_EQ(first % 7, 0u);
        length[first / 7] = last - first;
        for (std::size_t i = first; i < last; ++i) ++seen[i];
      });
      for (const auto& times : seen) EXPECT_EQ(times, 1);
      for (std::size_t i = 0; i < length.size(); ++i) EXPECT_EQ(length[i], std::min<std::size_t>(7, count - 7 * i));
    }
  }
}

TEST(Parallel, AsManyThreadsAsAskedForAndNoMoreThanTasks) {
  Context context;
  context.threads = 3;
  std::latch together(3);  // passes only when three threads are here at once
  parallel_tasks(context, 3, [&](std::size_t) { together.arrive_and_wait(); });

  context.threads = 1;
  parallel_tasks(context, 10,
                 [caller = std::this_thread::get_id()](std::size_t) { EXPECT_EQ(std::this_thread::get_id(), caller); });
}

TEST(Parallel, TheFirstFailureInOrderReachesTheCaller) {
  for (const int threads : {1, 2, 4}) {
    Context context;
    context.threads = threads;
    std::atomic<int> done = 0;
    for (int round = 0; round < 200; ++round) {
      try {
        parallel_tasks(context, 100, [&](std::size_t i) {
          ++done;
          if (i == 5) std::this_thread::yield();  // let a later one fail before
          if (i >= 5) throw std::runtime_error(std::to_string(i));
        });
        FAIL() << "nothing was thrown";
      } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "5");
      }
    }
    EXPECT_LE(done, 200 * (5 + threads));
  }
}

TEST(Parallel, StopsWhenCancelled) {
  for (const int threads : {1, 2}) {
    Context context;
    context.threads = threads;
    std::atomic<int> done = 0;
    try {
      parallel_tasks(context, 1000, [&](std::size_t) {
        ++done;
        context.cancelled = true;
      });
      FAIL() << "not cancelled";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind, ErrorKind::cancelled);
    }
    EXPECT_LE(done, threads);
  }
}
