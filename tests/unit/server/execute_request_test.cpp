// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/requests/execute_request.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "ops/base64.hpp"

namespace terrane {
namespace {

using Pairs = std::vector<std::pair<std::string, std::string>>;

const Operation& merge() { return find_operation("merge"); }

std::string code_of(const std::string& body) {
  try {
    ask_from_json(merge(), body);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::usage);
    return error.code;
  }
  return "";
}

FormPart file(std::string name, std::string file_name, std::string content) {
  return {std::move(name), true, std::move(file_name), "application/octet-stream", std::move(content)};
}

FormPart field(std::string name, std::string content) { return {std::move(name), false, "", "", std::move(content)}; }

TEST(ExecuteRequest, AFormHoldsInputsInOrderAndParameters) {
  const Ask ask = ask_from_form(merge(), {field("overlap", "min"), file("tiles", "b.obj", "B"), field("tiles", "12.5"),
                                          file("tiles", "a.obj", "A"), field("f", "ply")});
  ASSERT_EQ(ask.request.inputs.size(), 3u);
  EXPECT_EQ(ask.request.inputs[0].name, "b.obj");
  EXPECT_EQ(ask.request.inputs[1].bytes, "12.5");
  EXPECT_EQ(ask.request.inputs[2].bytes, "A");
  EXPECT_EQ(ask.request.format, "ply");
  EXPECT_EQ(ask.request.parameters, (Pairs{{"overlap", "min"}}));
}

TEST(ExecuteRequest, AFileFieldInWhichNothingWasChosenIsNoInput) {
  EXPECT_TRUE(ask_from_form(merge(), {file("tiles", "", "")}).request.inputs.empty());
}

TEST(ExecuteRequest, AFileOfAnUnknownNameIsAnUnknownInputNotAParameter) {
  EXPECT_EQ(ask_from_form(merge(), {file("tile", "a.obj", "A")}).request.inputs.at(0).slot, "tile");
}

TEST(ExecuteRequest, JsonInputsOfEveryKind) {
  const Ask ask = ask_from_json(merge(), R"({"inputs": {"tiles": [
      12.50, "v 0 0 0", {"type": "TIN", "vertices": [[0, 0, 1e400]]},
      {"value": "diAwIDAgMAo=", "encoding": "base64", "mediaType": "model/obj", "name": "t.obj"},
      {"value": {"type": "TIN"}}], "overlap": "max", "z-tolerance": 0.10, "levels": [1, 2.50, "x"], "flag": true},
      "outputs": {}, "response": "document"})");
  EXPECT_TRUE(ask.as_document);
  ASSERT_EQ(ask.request.inputs.size(), 5u);
  EXPECT_EQ(ask.request.inputs[0].bytes, "12.50");
  EXPECT_EQ(ask.request.inputs[1].bytes, "v 0 0 0");
  EXPECT_EQ(ask.request.inputs[2].bytes, R"({"type": "TIN", "vertices": [[0, 0, 1e400]]})");
  EXPECT_EQ(ask.request.inputs[3].bytes, "v 0 0 0\n");
  EXPECT_EQ(ask.request.inputs[3].media_type, "model/obj");
  EXPECT_EQ(ask.request.inputs[3].name, "t.obj");
  EXPECT_EQ(ask.request.inputs[4].bytes, R"({"type": "TIN"})");
  EXPECT_EQ(ask.request.parameters,
            (Pairs{{"overlap", "max"}, {"z-tolerance", "0.10"}, {"levels", "1,2.50,x"}, {"flag", "true"}}));
}

TEST(ExecuteRequest, AReferenceMayHaveAFormatAsAValueHas) {
  const Ask ask = ask_from_json(merge(), R"({"inputs": {"tiles": [
    {"href": "/uploads/1", "type": "model/obj", "rel": "data"},
    {"href": "/uploads/2", "format": {"mediaType": "model/obj", "encoding": "utf-8", "schema": "x"}}]}})");
  ASSERT_EQ(ask.request.inputs.size(), 2u);
  EXPECT_EQ(ask.request.inputs[1].href, "/uploads/2");
  for (const auto& input : ask.request.inputs) EXPECT_EQ(input.media_type, "model/obj");
}

TEST(ExecuteRequest, TheOutputsFormatIsWhatIsAccepted) {
  std::string name;
  const nlohmann::json description = process_description(merge());
  for (const auto& output : description["outputs"].items()) {
    if (output.key() != "report") name = output.key();
  }
  const Ask ask = ask_from_json(
      merge(), R"({"inputs": {}, "outputs": {")" + name + R"(": {"format": {"mediaType": "model/obj"}}}})");
  EXPECT_EQ(ask.request.accept, std::vector<std::string>{"model/obj"});
  EXPECT_FALSE(ask.as_document);
}

TEST(ExecuteRequest, WhatIsNotUnderstoodIsRefused) {
  EXPECT_EQ(code_of("[]"), "invalid-json");
  EXPECT_EQ(code_of("{\"input\": {}}"), "unknown-member");
  EXPECT_EQ(code_of("{\"inputs\": []}"), "wrong-type");
  EXPECT_EQ(code_of("{\"inputs\": {\"tiles\": null}}"), "wrong-type");
  EXPECT_EQ(code_of("{\"inputs\": {\"tiles\": [[1]]}}"), "wrong-type");
  EXPECT_EQ(code_of("{\"inputs\": {\"tiles\": nan}}"), "invalid-json");
  EXPECT_EQ(code_of("{\"inputs\": {\"overlap\": null}}"), "wrong-type");
  EXPECT_EQ(code_of("{\"inputs\": {\"tiles\": {\"href\": \"http://localhost/x\"}}}"), "");
  EXPECT_EQ(code_of("{\"inputs\": {\"tiles\": {\"href\": \"http://localhost/x\", \"formats\": {}}}}"),
            "unknown-member");
  EXPECT_EQ(code_of("{\"inputs\": {\"tiles\": {\"value\": \"=\", \"encoding\": \"base64\"}}}"), "bad-base64");
  EXPECT_EQ(code_of("{\"inputs\": {\"tiles\": {\"value\": 1, \"encoding\": \"base64\"}}}"), "wrong-type");
  EXPECT_EQ(code_of("{\"inputs\": {\"tiles\": {\"value\": \"a\", \"encoding\": \"rot13\"}}}"), "bad-encoding");
  EXPECT_EQ(code_of("{\"inputs\": {}, \"outputs\": {\"nothing\": {}}}"), "unknown-output");
  EXPECT_EQ(code_of("{\"inputs\": {}, \"response\": \"both\"}"), "wrong-type");
  EXPECT_EQ(code_of("{\"inputs\": {\"f\": \"obj\", \"format\": \"ply\"}}"), "repeated-parameter");
}

TEST(Base64, RoundTripsAndIsStrict) {
  std::string bytes;
  for (int i = 0; i < 300; ++i) {
    EXPECT_EQ(decode_base64(encode_base64(bytes), "x"), bytes);
    bytes += static_cast<char>(i * 7);
  }
  EXPECT_EQ(encode_base64("Ma"), "TWE=");
  EXPECT_EQ(decode_base64("TW\r\nFu", "x"), "Man");
  for (const char* text : {"T", "TW", "TWE", "T===", "====", "TW=E", "TWE=TWE=", "TWFu=", "TW!u"}) {
    EXPECT_THROW(decode_base64(text, "x"), Error) << text;
  }
}

}  // namespace
}  // namespace terrane
