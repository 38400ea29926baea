// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "ops/errors.hpp"
#include "ops/operation.hpp"
#include "ops/parameters.hpp"

using namespace terrane;

namespace {

const char* const tent = R"({"type":"TIN","vertices":[[0,0,1],[10,0,2],[0,10,3]],"triangles":[[0,1,2]]})";

Request request(std::string operation, std::vector<std::string> slots) {
  Request made;
  made.operation = std::move(operation);
  for (const std::string& slot : slots) made.inputs.push_back({slot, slot + ".json", "", tent});
  return made;
}

Error refusal(Request r) {
  try {
    plan(std::move(r));
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "the request was not refused";
  return {ErrorKind::internal, "not-refused", ""};
}

bool says(const Error& error, std::string_view text) {
  return std::string_view(error.what()).find(text) != std::string_view::npos;
}

}  // namespace

TEST(Plan, UnknownOperationIsNamedWithTheList) {
  const Error e = refusal(request("mrge", {}));
  EXPECT_EQ(e.kind, ErrorKind::no_such_process);
  EXPECT_EQ(http_status(e.kind), 404);
  EXPECT_TRUE(says(e, "mrge") && says(e, "merge") && says(e, "convert")) << e.what();
}

TEST(Plan, UnknownParameterIsNamedWithTheList) {
  Request r = request("merge", {"tiles"});
  r.parameters = {{"overlp", "max"}};
  const Error e = refusal(r);
  EXPECT_EQ(http_status(e.kind), 400);
  EXPECT_TRUE(says(e, "overlp") && says(e, "overlap") && says(e, "max-error")) << e.what();
}

TEST(Plan, WrongTypesRangesAndChoicesAreRefused) {
  const std::vector<std::array<std::string, 3>> cases = {
      {"merge", "overlap", "median-ish"}, {"merge", "max-error", "five"},  {"merge", "max-error", "-1"},
      {"merge", "max-error", "nan"},      {"merge", "max-error", "1e400"}, {"merge", "threads", "1.5"},
      {"merge", "threads", "-1"},         {"merge", "crs", "EPSG:abc"},    {"merge", "target-crs", "nonsense"},
      {"merge", "z-tolerance", "5 miles"}};
  for (const auto& [operation, name, value] : cases) {
    Request r = request(operation, {"tiles"});
    r.parameters = {{name, value}};
    const Error e = refusal(r);
    EXPECT_EQ(e.kind, ErrorKind::usage) << name << "=" << value;
    EXPECT_TRUE(says(e, name)) << e.what();
  }
  Request circle = request("synthesize-circle", {});
  circle.parameters = {{"samples", "2"}};
  EXPECT_TRUE(says(refusal(circle), "from 3 up to 1000000"));
}

TEST(Plan, AParameterTwiceIsRefused) {
  Request r = request("merge", {"tiles"});
  r.parameters = {{"overlap", "max"}, {"overlap", "min"}};
  EXPECT_EQ(refusal(r).code, "repeated-parameter");
}

TEST(Plan, ParametersThatNothingComesOfAreRefused) {
  using Values = std::vector<std::pair<std::string, std::string>>;
  struct Case {
    const char *operation, *slot;
    Values meant, idle;
  };
  for (const auto& [operation, slot, meant, idle] : std::vector<Case>{
           {"merge", "tiles", {{"overlap", "blend"}, {"blend-width", "2"}}, {{"blend-width", "2"}}},
           {"seams", "tiles", {{"overlap", "mean"}}, {{"overlap", "mean"}, {"blend-side", "inside"}}},
           {"merge", "tiles", {{"wall-offset", "1"}}, {{"wall-offset", "1"}, {"seam", "ramp"}}},
           {"contour", "surface", {{"interval", "2"}, {"base", "1"}}, {{"levels", "1,2"}, {"base", "1"}}},
           {"quantize", "surface", {{"levels", "1,2"}, {"base", "0"}}, {{"levels", "1,2"}, {"base", "1"}}},
           {"clip",
            "surface",
            {{"region", "0,0;1,0;1,1"}, {"region-crs", "EPSG:25831"}},
            {{"bbox", "0,0,1,1"}, {"region-crs", "EPSG:25831"}}}}) {
    Request r = request(operation, {slot});
    r.parameters = meant;
    EXPECT_NO_THROW(plan(r)) << operation;
    r.parameters = idle;
    const Error e = refusal(r);
    EXPECT_EQ(e.code, "surplus-parameter") << operation;
    EXPECT_TRUE(says(e, idle.back().first) || says(e, idle.front().first)) << e.what();
  }
}

TEST(Plan, InputsAreCounted) {
  EXPECT_EQ(refusal(request("subtract", {"minuend"})).code, "missing-input");
  EXPECT_EQ(refusal(request("subtract", {"minuend", "subtrahend", "subtrahend"})).code, "surplus-input");
  EXPECT_EQ(refusal(request("subtract", {"minuend", "subtrahend", "tiles"})).code, "unknown-input");
  EXPECT_EQ(refusal(request("volume", {"surface"})).code, "missing-input");
  EXPECT_NO_THROW(plan(request("merge", {"tiles", "tiles", "tiles"})));
}

TEST(Plan, DefaultsAreFilledInAndLengthsKeepTheirUnit) {
  Request r = request("merge", {"tiles"});
  r.parameters = {{"max-error", "5 ft"}};
  const Plan made = plan(r);
  EXPECT_EQ(made.parameters.at("overlap"), "first");
  EXPECT_EQ(made.parameters.at("max-error"), "5ft");
  EXPECT_DOUBLE_EQ(Length::of(made.parameters.at("max-error")).in(1), 1.524);
  EXPECT_DOUBLE_EQ(Length::of("1ftUS").in(1), 1200.0 / 3937.0);
  EXPECT_DOUBLE_EQ(Length::of(2.5).in(0.3048), 2.5);
}

TEST(Plan, ANumberIsASurfaceOnlyWhereALevelIsTaken) {
  Request r = request("subtract", {"minuend"});
  r.inputs.push_back({"subtrahend", "", "", "-12.5"});
  EXPECT_NO_THROW(plan(r));
  Request info = request("info", {});
  info.inputs.push_back({"surface", "", "", "12.5"});
  EXPECT_EQ(refusal(info).kind, ErrorKind::unsupported);
}

TEST(Plan, FormatGoesByWordThenNameThenAccept) {
  Request r = request("merge", {"tiles"});
  EXPECT_EQ(plan(r).output_format, "json");
  r.accept = {"image/png", "model/obj;q=0.9", "*/*"};
  EXPECT_EQ(plan(r).output_format, "obj");
  r.output_name = "x.ply";
  EXPECT_EQ(plan(r).output_format, "ply");
  r.format = "json";
  EXPECT_EQ(plan(r).output_format, "json");
}

TEST(Plan, AFormatThatCannotBeIsRefusedWithTheList) {
  Request r = request("merge", {"tiles"});
  r.format = "shapefile";
  Error e = refusal(r);
  EXPECT_EQ(http_status(e.kind), 400);
  EXPECT_TRUE(says(e, "obj") && says(e, "ply")) << e.what();
  r.format.clear();
  r.accept = {"image/gif"};
  e = refusal(r);
  EXPECT_EQ(http_status(e.kind), 406);
  EXPECT_TRUE(says(e, "model/obj")) << e.what();
}

TEST(Plan, CityJsonIsNoOtherJson) {
  Request r = request("convert", {"surface"});
  r.output_name = "Terrain.City.json";
  EXPECT_TRUE(says(refusal(r), "'city.json'; formats are json, obj"));
}

TEST(Plan, ValidateReturnsASurfaceOnlyWhenItRepairs) {
  Request r = request("validate", {"surface"});
  r.format = "obj";
  EXPECT_EQ(refusal(r).code, "unknown-format");
  r.parameters = {{"repair", "true"}};
  EXPECT_EQ(plan(r).output_format, "obj");
}

TEST(Plan, AnInputInNoKnownFormatIs415) {
  Request r = request("info", {});
  r.inputs = {{"surface", "notes.docx", "", "not a surface at all"}};
  EXPECT_EQ(http_status(refusal(r).kind), 415);
  r.inputs = {{"surface", "x.obj", "image/jpeg", tent}};
  EXPECT_EQ(http_status(refusal(r).kind), 415);
  r.inputs = {{"surface", "", "application/octet-stream", tent}};
  EXPECT_NO_THROW(plan(r));
}

TEST(Parameters, WhichCrsIsMeantForWhichInput) {
  const std::vector<std::string> names = {"a", "a.tif", "tiles"};
  const auto rules = parse_crs_rules("EPSG:4326; a.tif:local:m;tiles:EPSG:25831", names);
  ASSERT_EQ(rules.size(), 3u);
  EXPECT_EQ(rules[0].input + "|" + rules[0].crs, "|EPSG:4326");
  EXPECT_EQ(rules[1].input + "|" + rules[1].crs, "a.tif|local:m");
  EXPECT_EQ(rules[2].input + "|" + rules[2].crs, "tiles|EPSG:25831");
}

TEST(Errors, EachKindHasItsStatusAndExitCode) {
  EXPECT_EQ(http_status(ErrorKind::input), 422);
  EXPECT_EQ(http_status(ErrorKind::limit), 413);
  EXPECT_EQ(http_status(ErrorKind::busy), 503);
  EXPECT_EQ(exit_code(ErrorKind::usage), 2);
  EXPECT_EQ(exit_code(ErrorKind::input), 3);
  EXPECT_EQ(exit_code(ErrorKind::limit), 4);
  EXPECT_EQ(exit_code(ErrorKind::internal), 5);
  const auto told = problem(Error(ErrorKind::internal, "broken", "secret detail"));
  EXPECT_EQ(told.dump().find("secret"), std::string::npos);
  EXPECT_EQ(problem(Error(ErrorKind::input, "no-overlap", "x"))["type"], "/problems/no-overlap");
}
