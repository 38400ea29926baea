// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "ops/openapi/yaml.hpp"
#include "ops/operation.hpp"

using namespace terrane;

namespace {

std::string committed(const std::string& path) {
  std::ifstream file(TERRANE_SOURCE_DIR "/" + path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

TEST(Generated, OpenapiIsFresh) {
  EXPECT_EQ(committed("openapi.yaml"), openapi_yaml()) << "run: terrane docs openapi > openapi.yaml";
}

TEST(Generated, ReferenceIsFresh) {
  EXPECT_EQ(committed("docs/reference.md"), reference_page()) << "run: terrane docs reference > docs/reference.md";
}

TEST(Catalogue, EveryOperationIsDescribedOnce) {
  std::set<std::string> ids;
  for (const Operation& operation : catalogue()) {
    EXPECT_TRUE(ids.insert(operation.id).second) << operation.id;
    EXPECT_FALSE(operation.title.empty() || operation.description.empty()) << operation.id;
    EXPECT_FALSE(operation.output_formats.empty()) << operation.id;
    EXPECT_NE(static_cast<bool>(operation.run), static_cast<bool>(operation.run_plain)) << operation.id;
    std::set<std::string> names;
    const std::vector<Parameter> common = common_parameters_of(operation);
    for (const auto* list : {&operation.parameters, &common})
      for (const Parameter& p : *list) {
        EXPECT_TRUE(names.insert(p.name).second) << operation.id << " " << p.name;
        EXPECT_FALSE(p.sentence.empty()) << operation.id << " " << p.name;
      }
    for (const InputSlot& slot : operation.inputs)
      EXPECT_TRUE(names.insert(slot.name).second) << "an input and a parameter share the name " << slot.name;
  }
  for (const char* id : {"triangulate", "add",       "subtract",  "merge",    "volume",    "validate", "info",
                         "convert",     "transform", "render",    "and",      "or",        "xor",      "nand",
                         "nor",         "not",       "threshold", "quantize", "rasterize", "profile",  "sample"})
    EXPECT_TRUE(ids.contains(id)) << id;
}

TEST(Catalogue, ADescriptionHoldsWhatTheStandardAsksFor) {
  for (const Operation& operation : catalogue()) {
    const auto description = process_description(operation);
    EXPECT_EQ(description["id"], operation.id);
    for (const char* key : {"version", "jobControlOptions", "outputTransmission", "inputs", "outputs"})
      EXPECT_TRUE(description.contains(key)) << operation.id << " " << key;
    for (const auto& [name, input] : description["inputs"].items()) EXPECT_TRUE(input.contains("schema")) << name;
    for (const auto& [name, output] : description["outputs"].items()) EXPECT_TRUE(output.contains("schema")) << name;
  }
  EXPECT_EQ(process_description(find_operation("merge"))["inputs"]["tiles"]["maxOccurs"], "unbounded");
}

TEST(Yaml, QuotesWhatCouldBeTakenForSomethingElse) {
  EXPECT_EQ(yaml({{"a", "true"}, {"b", true}, {"200", {1, {{"c", nullptr}}}}, {"d", nlohmann::json::array()}}),
            "\"200\":\n  - 1\n  - c: null\na: \"true\"\nb: true\nd: []\n");
}
