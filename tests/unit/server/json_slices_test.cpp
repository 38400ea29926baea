// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/requests/json_slices.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"

namespace terrane {
namespace {

template <class Work>
std::string code_of(Work work) {
  try {
    work();
  } catch (const Error& error) {
    return error.code;
  }
  return "";
}

std::string nested(int depth) { return std::string(depth, '[') + std::string(depth, ']'); }

TEST(JsonSlices, MembersKeepTheirText) {
  const auto members = json_members(R"( {"a" : 1.50 ,"b\n":{"x":["}",{}]}, "c":"\"]" } )");
  ASSERT_EQ(members.size(), 3u);
  EXPECT_EQ(members[0].first, "a");
  EXPECT_EQ(members[0].second, "1.50");
  EXPECT_EQ(members[1].first, "b\n");
  EXPECT_EQ(members[1].second, R"({"x":["}",{}]})");
  EXPECT_EQ(members[2].second, R"("\"]")");
  EXPECT_TRUE(json_members("{}").empty());
}

TEST(JsonSlices, ElementsKeepTheirText) {
  const auto elements = json_elements(R"([1, "a,b", [2,[3]], {"x":1}])");
  ASSERT_EQ(elements.size(), 4u);
  EXPECT_EQ(elements[1], R"("a,b")");
  EXPECT_EQ(elements[2], "[2,[3]]");
}

TEST(JsonSlices, WhatIsNotJsonIsRefused) {
  for (const char* text :
       {"", "[", "{", "{\"a\"}", "{\"a\":}", "{\"a\":1,}", "{\"a\":1}x", "{\"a\":1 2}", "{\"a\":[}]}", "{\"a\":[1}",
        "{\"a\":\"x}", "{a:1}", "{\"a\":1", "{\"a\":\"\\", "{\"\\q\":1}", "{\"a\":1,\"a\":2}"}) {
    EXPECT_EQ(code_of([&] { json_members(text); }), "invalid-json") << text;
  }
  EXPECT_EQ(code_of([&] { json_elements("{}"); }), "invalid-json");
  EXPECT_EQ(code_of([&] { json_elements("[1,]"); }), "invalid-json");
}

TEST(JsonSlices, DepthAndCountAreBounded) {
  EXPECT_EQ(code_of([&] { json_members("{\"a\":" + nested(64) + "}"); }), "");
  EXPECT_EQ(code_of([&] { json_members("{\"a\":" + nested(65) + "}"); }), "invalid-json");
  EXPECT_EQ(code_of([&] { json_members("{\"a\":" + std::string(1 << 22, '[')); }), "invalid-json");
  EXPECT_EQ(code_of([&] { parse_json(nested(64), "x"); }), "");
  EXPECT_EQ(code_of([&] { parse_json(nested(100'000), "x"); }), "invalid-json");
  std::string many = "[0";
  for (std::size_t i = 0; i < max_json_members; ++i) many += ",0";
  EXPECT_EQ(code_of([&] { json_elements(many + "]"); }), "too-many-values");
}

TEST(JsonSlices, MessagesNameThePlaceAndNotTheLibrary) {
  try {
    parse_json("{\"a\":1,}", "parameter levels");
    FAIL();
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("parameter levels"), std::string::npos);
    EXPECT_EQ(text.find("json.exception"), std::string::npos);
  }
}

}  // namespace
}  // namespace terrane
