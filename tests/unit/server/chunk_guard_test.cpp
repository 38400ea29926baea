// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/chunk_guard.hpp"

#include <string>

#include <gtest/gtest.h>

namespace terrane {
namespace {

constexpr std::string_view good = "5\r\nabcde\r\nA;x=y\r\n0123456789\r\n0\r\n\r\n";

TEST(ChunkGuard, LetsGoodFramingPassHoweverItIsCut) {
  for (std::size_t piece = 1; piece <= good.size(); ++piece) {
    ChunkGuard guard;
    for (std::size_t i = 0; i < good.size(); i += piece) ASSERT_TRUE(guard.accepts(good.substr(i, piece))) << piece;
    EXPECT_TRUE(guard.is_complete());
  }
}

TEST(ChunkGuard, ACutBodyIsNotComplete) {
  for (std::size_t length = 0; length < good.size(); ++length) {
    ChunkGuard guard;
    EXPECT_TRUE(guard.accepts(good.substr(0, length)));
    EXPECT_FALSE(guard.is_complete());
  }
}

TEST(ChunkGuard, BrokenFramingIsSeenAtOnce) {
  for (const std::string& body :
       {std::string("-2\r\n"), std::string("\r\n"), std::string("x\r\n"), std::string("5\n"),
        std::string("5\r\nabcdeX"), std::string("5\r\nabcde\r5"), std::string("0\r\nTrailer: 1"),
        std::string("ffffffffffffffff\r\n"), "1;" + std::string(300, 'a'), std::string(good) + "x"}) {
    ChunkGuard guard;
    EXPECT_FALSE(guard.accepts(body)) << body.substr(0, 40);
  }
}

}  // namespace
}  // namespace terrane
