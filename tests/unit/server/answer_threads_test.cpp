// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/answer_threads.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <future>

namespace terrane {
namespace {

TEST(AnswerThreads, LongWorkLeavesThreadsForShortWork) {
  std::promise<void> end;
  const std::shared_future<void> ended = end.get_future().share();
  std::atomic<int> begun = 0;
  AnswerThreads threads(3, 2, 10, 3);
  const auto add_long = [&] {
    return threads.add_long([&] {
      ++begun;
      ended.wait();
    });
  };
  EXPECT_TRUE(add_long());
  EXPECT_TRUE(add_long());
  while (begun < 2) std::this_thread::yield();
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(add_long());
  EXPECT_FALSE(add_long()) << "the line is full";
  for (int i = 0; i < 100; ++i) {
    std::promise<void> done;
    ASSERT_TRUE(threads.add_short([&] { done.set_value(); }));
    done.get_future().wait();
  }
  EXPECT_EQ(begun, 2);
  end.set_value();
}

TEST(AnswerThreads, DoAllThatIsInTheLinesBeforeTheyEnd) {
  std::atomic<int> done = 0;
  for (int round = 0; round < 50; ++round) {
    AnswerThreads threads(4, 1, 1000, 1000);
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(threads.add_short([&] { ++done; }));
      ASSERT_TRUE(threads.add_long([&] { ++done; }));
    }
  }
  EXPECT_EQ(done, 50 * 200);
}

}  // namespace
}  // namespace terrane
