// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/chunk_guard.hpp"

#include <gtest/gtest.h>

#include <string>

namespace terrane {
namespace {

constexpr std::string_view good = "5\r\nabcde\r\nA;x=y\r\n0123456789\r\n0\r\n\r\n";

TEST(ChunkGuard, TakesGoodFramingApartHoweverItIsCut) {
  for (std::size_t piece = 1; piece <= good.size(); ++piece) {
    ChunkGuard guard;
    std::string data;
    for (std::size_t i = 0; i < good.size(); i += piece) {
      const auto taken = guard.take(good.substr(i, piece), [&](std::string_view more) { data += more; });
      ASSERT_EQ(taken, std::min(piece, good.size() - i)) << piece;
    }
    EXPECT_TRUE(guard.is_complete());
    EXPECT_EQ(data, "abcde0123456789");
  }
}

TEST(ChunkGuard, ACutBodyIsNotComplete) {
  for (std::size_t length = 0; length < good.size(); ++length) {
    ChunkGuard guard;
    EXPECT_EQ(guard.take(good.substr(0, length), [](std::string_view) {}), length);
    EXPECT_FALSE(guard.is_complete());
  }
}

TEST(ChunkGuard, LeavesTheNextRequestAlone) {
  ChunkGuard guard;
  EXPECT_EQ(guard.take(std::string(good) + "GET /", [](std::string_view) {}), good.size());
  EXPECT_EQ(guard.take("GET /", [](std::string_view) {}), 0);
}

TEST(ChunkGuard, BrokenFramingIsSeenAtOnce) {
  for (const std::string& body :
       {std::string("-2\r\n"), std::string("\r\n"), std::string("x\r\n"), std::string("5\n"),
        std::string("5\r\nabcdeX"), std::string("5\r\nabcde\r5"), std::string("0\r\nTrailer: 1"),
        std::string("ffffffffffffffff\r\n"), "1;" + std::string(300, 'a')}) {
    ChunkGuard guard;
    EXPECT_FALSE(guard.take(body, [](std::string_view) {})) << body.substr(0, 40);
  }
}

}  // namespace
}  // namespace terrane
