// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/incoming.hpp"

#include <gtest/gtest.h>

#include <filesystem>

namespace terrane {
namespace {

const std::string folder = std::filesystem::temp_directory_path().string();

std::string all_of(const Spool& spool) {
  std::string text(static_cast<std::size_t>(spool.size()) + 10, '\0');
  text.resize(spool.read(0, text.data(), text.size()));
  return text;
}

TEST(Incoming, TakesItsBodyAndLeavesTheRest) {
  SpoolBudget budget(folder, 1 << 20, 1 << 20);
  const std::string head = "POST / HTTP/1.1\r\nHost: x\r\n";
  Incoming sized(parse_head(head + "Content-Length: 5\r\n\r\n"), budget, "a", 10);
  EXPECT_EQ(sized.take("ab"), 2);
  EXPECT_FALSE(sized.is_complete());
  EXPECT_EQ(sized.missing(), 3);
  EXPECT_EQ(sized.take("cdeGET"), 3);
  EXPECT_TRUE(sized.is_complete());
  EXPECT_EQ(all_of(sized.body), "abcde");

  Incoming chunks(parse_head(head + "Transfer-Encoding: chunked\r\n\r\n"), budget, "a", 10);
  EXPECT_EQ(chunks.take("2\r\nab\r\n3\r\ncde\r\n0\r\n\r\nGET"), 20);
  EXPECT_TRUE(chunks.is_complete());
  EXPECT_EQ(all_of(chunks.body), "abcde");

  Incoming large(parse_head(head + "Transfer-Encoding: chunked\r\n\r\n"), budget, "a", 10);
  EXPECT_THROW(large.take("b\r\n0123456789a\r\n"), HttpError);
}

}  // namespace
}  // namespace terrane
