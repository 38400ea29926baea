// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <set>

#include "ops/operation.hpp"

using namespace terrane;
using Json = nlohmann::json;

namespace {

/// Every word that stands anywhere in a document, but not what examples hold.
void collect(const Json& value, std::set<std::string>& words) {
  if (value.is_array())
    for (const Json& element : value) collect(element, words);
  if (!value.is_object()) return;
  for (const auto& [key, inner] : value.items()) {
    words.insert(key);
    if (key != "example") collect(inner, words);
  }
}

}  // namespace

TEST(OpenApi, BothVersionsDescribeTheSame) {
  const Json newer = openapi(), older = openapi_30();
  EXPECT_EQ(newer["openapi"], "3.1.0");
  EXPECT_EQ(older["openapi"], "3.0.3");
  EXPECT_EQ(newer["paths"].size(), older["paths"].size());
  for (const auto& [path, item] : newer["paths"].items())
    for (const auto& [method, operation] : item.items())
      if (operation.is_object()) {
        EXPECT_EQ(operation["operationId"], older["paths"][path][method]["operationId"]);
      }
}

TEST(OpenApi, TheOlderOneHasNoWordsOfTheNewer) {
  std::set<std::string> words;
  collect(openapi_30(), words);
  for (const char* word : {"const", "contentMediaType", "contentEncoding", "identifier", "examples", "webhooks"})
    EXPECT_FALSE(words.contains(word)) << word;
}

TEST(OpenApi, EveryReferenceLeadsSomewhere) {
  for (const Json& document : {openapi(), openapi_30()}) {
    const auto check = [&](const Json& value, const auto& self) -> void {
      if (const auto it = value.is_object() ? value.find("$ref") : value.end(); it != value.end() && it->is_string()) {
        EXPECT_TRUE(document.contains(Json::json_pointer(it->get<std::string>().substr(1)))) << *it;
      }
      if (value.is_structured())
        for (const Json& inner : value) self(inner, self);
    };
    check(document, check);
  }
}
