// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <chrono>

#include "core/error.hpp"
#include "ops/json_value.hpp"
#include "ops/operation.hpp"
#include "ops/request.hpp"

using namespace terrane;
using Json = nlohmann::json;

namespace {

Response echoed(std::vector<std::pair<std::string, std::string>> parameters, std::vector<InputPart> inputs = {}) {
  Request request;
  request.operation = "echo";
  request.parameters = std::move(parameters);
  request.inputs = std::move(inputs);
  Context context;
  return execute(plan(std::move(request)), context);
}

std::string refusal(const std::string& name, const std::string& text) {
  try {
    echoed({{name, text}});
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::usage);
    return error.what();
  }
  return "";
}

}  // namespace

TEST(Echo, GivesBackWhatItGot) {
  const Response response =
      echoed({{"answer", "hello"}, {"number", "5"}, {"array", "[1, 2.5]"}, {"object", R"({"a": {"b": null}})"}},
             {{.slot = "file", .name = "a.bin", .media_type = "image/png", .bytes = std::string("\0x", 2)}});
  const Json all = Json::parse(response.body);
  EXPECT_EQ(all["answer"], "hello");
  EXPECT_EQ(all["number"].dump(), "5");
  EXPECT_EQ(all["array"].dump(), "[1,2.5]");
  EXPECT_EQ(all["object"].dump(), R"({"a":{"b":null}})");
  EXPECT_EQ(all["file"]["value"], "AHg=");
  EXPECT_FALSE(all.contains("flag"));
  ASSERT_EQ(response.parts.size(), 5u);
  EXPECT_EQ(response.parts[0].id, "answer");
  EXPECT_EQ(response.parts[0].body, "\"hello\"\n");
  EXPECT_EQ(response.parts[4].id, "file");
  EXPECT_EQ(response.parts[4].media_type, "image/png");
  EXPECT_EQ(response.parts[4].body, std::string("\0x", 2));
  EXPECT_TRUE(response.report.is_null());
}

TEST(Echo, ReadsAFileThatIsNotHeld) {
  const std::string bytes(100000, 'y');
  InputPart part{.slot = "file", .name = "", .media_type = "", .bytes = "y"};
  part.open = [&] {
    auto at = std::make_shared<std::size_t>(0);
    return InputStream{[&bytes, at](char* to, std::size_t size) {
                         const std::size_t count = bytes.copy(to, std::min<std::size_t>(size, 4096), *at);
                         *at += count;
                         return count;
                       },
                       bytes.size()};
  };
  const Response response = echoed({}, {part});
  EXPECT_EQ(response.parts.at(0).body, bytes);
  EXPECT_EQ(response.parts.at(0).media_type, "application/octet-stream");
}

TEST(Echo, HoldsWhatItGetsToItsSchema) {
  EXPECT_NE(refusal("number", "\"5\"").find("number"), std::string::npos);
  EXPECT_NE(refusal("bbox", R"({"bbox": [1, 2, 3]})").find("bbox"), std::string::npos);
  EXPECT_NE(refusal("bbox", R"({"crs": "x"})").find("needs the member bbox"), std::string::npos);
  EXPECT_NE(refusal("array", R"([1, "b"])").find("element"), std::string::npos);
  EXPECT_NE(refusal("object", "[]").find("object"), std::string::npos);
  EXPECT_NE(refusal("object", "{").find("JSON"), std::string::npos);
  EXPECT_NE(refusal("object", std::string(100000, '[')).find("deeper"), std::string::npos);
  EXPECT_NE(refusal("flag", "1").find("boolean"), std::string::npos);
  EXPECT_NE(refusal("pause", "61").find("60"), std::string::npos);
  EXPECT_NE(refusal("crs", "EPSG:25831").find("no parameter"), std::string::npos);
  EXPECT_EQ(refusal("bbox", R"({"bbox": [1, 2, 3, 4, 5, 6], "crs": "x"})"), "");
}

TEST(Echo, PausesWithProgressUntilItIsCancelled) {
  Request request;
  request.operation = "echo";
  request.parameters = {{"pause", "60"}};
  const Plan made = plan(std::move(request));
  Context context;
  int reports = 0;
  context.on_progress = [&](std::string_view stage, double fraction) {
    EXPECT_EQ(stage, "pause");
    EXPECT_LT(fraction, 0.1);
    if (++reports == 3) context.cancelled = true;
  };
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THROW(execute(made, context), Error);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
  EXPECT_GE(reports, 3);
}

TEST(JsonValue, KnowsTheWordsOfItsSchemas) {
  const auto refused = [](const char* text, const Json& schema) {
    try {
      parse_json_value(text, schema, "it");
      return false;
    } catch (const Error&) {
      return true;
    }
  };
  EXPECT_TRUE(refused("5", {{"minimum", 6}}));
  EXPECT_TRUE(refused("5", {{"maximum", 4}}));
  EXPECT_FALSE(refused("5", {{"minimum", 5}, {"maximum", 5}, {"type", "integer"}}));
  EXPECT_TRUE(refused("5.5", {{"type", "integer"}}));
  EXPECT_TRUE(refused("\"c\"", {{"enum", {"a", "b"}}}));
  EXPECT_TRUE(refused(R"({"a": 1})", {{"properties", {{"a", {{"type", "string"}}}}}}));
  EXPECT_FALSE(refused("5", {{"oneOf", {{{"type", "string"}}, {{"type", "number"}}}}}));
  EXPECT_TRUE(refused("true", {{"oneOf", {{{"type", "string"}}, {{"type", "number"}}}}}));
}
