// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/spool.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/error.hpp"
#include "server/http/http_limits.hpp"
#include "server/http/message.hpp"

namespace terrane {
namespace {

const std::string folder = std::filesystem::temp_directory_path().string();

std::string all_of(const Spool& spool) {
  std::string text(static_cast<std::size_t>(spool.size()) + 10, '\0');
  text.resize(spool.read(0, text.data(), text.size()));
  return text;
}

TEST(Spool, GivesBackWhatItGotInMemoryAndInAFile) {
  SpoolBudget budget(folder, 1 << 20, 1 << 20);
  Spool spool(budget, "a");
  std::string expected;
  for (std::size_t i = 0; expected.size() < 2 * http_limits::spool_in_memory; ++i) {
    const std::string piece(997, static_cast<char>('a' + i % 26));
    spool.append(piece);
    expected += piece;
    if (i % 40 == 0) {
      ASSERT_EQ(all_of(spool), expected);
    }
  }
  EXPECT_EQ(all_of(spool), expected);
  char two[2];
  EXPECT_EQ(spool.read(expected.size() - 1, two, 2), 1);
  EXPECT_EQ(spool.read(expected.size(), two, 2), 0);
}

TEST(Spool, CountsForItsOwnerAndForAll) {
  SpoolBudget budget(folder, 150, 100);
  Spool first(budget, "a"), second(budget, "b");
  first.append(std::string(100, 'x'));
  EXPECT_THROW(first.append("x"), HttpError);
  second.append(std::string(50, 'x'));
  EXPECT_THROW(second.append("x"), Error);
  EXPECT_EQ(first.size() + second.size(), 150);
  first.clear();
  second.append(std::string(50, 'y'));
  EXPECT_THROW(Spool(budget, "b").append("x"), HttpError) << "by owner, not by spool";
}

TEST(Spool, MemoryIsBoundedOverAll) {
  SpoolBudget budget(folder, std::size_t{1} << 30, std::size_t{1} << 30);
  ASSERT_TRUE(budget.take_memory(http_limits::spools_in_memory));
  Spool spool(budget, "a");
  spool.append("in a file");
  EXPECT_EQ(all_of(spool), "in a file");
  EXPECT_FALSE(budget.take_memory(1));
  budget.give_back_memory(http_limits::spools_in_memory);
}

TEST(Spool, AFolderThatIsGoneIsOurFault) {
  SpoolBudget budget(folder + "/there is no such folder", 1 << 20, 1 << 20);
  Spool spool(budget, "a");
  spool.append("small");
  EXPECT_THROW(spool.append(std::string(http_limits::spool_in_memory, 'x')), Error);
  EXPECT_EQ(all_of(spool), "small") << "nothing was appended";
}

TEST(Spool, OwnersAreAddressesOrNetworks) {
  EXPECT_EQ(spool_owner("10.0.0.1"), "10.0.0.1");
  EXPECT_EQ(spool_owner("2001:db8::1"), spool_owner("2001:db8::ffff:2"));
  EXPECT_NE(spool_owner("2001:db8::1"), spool_owner("2001:db8:0:1::1"));
  EXPECT_NE(spool_owner("::ffff:10.0.0.1"), spool_owner("::ffff:10.0.0.2"));
}

}  // namespace
}  // namespace terrane
