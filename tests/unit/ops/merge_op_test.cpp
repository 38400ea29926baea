// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "unit/ops/requests.hpp"

namespace terrane {
namespace {

std::string square(double x, double y, double size, double height, const std::string& crs = "local:m") {
  return terrane::square(x, y, size, height, 0, crs);
}

InputPart tile(const std::string& bytes, const std::string& name) { return {"tiles", name, "", bytes}; }
InputPart level(const std::string& number) { return {"tiles", "", "", number}; }

Error refusal(std::vector<InputPart> inputs, Parameters parameters) {
  return terrane::refusal("merge", std::move(inputs), std::move(parameters));
}

std::vector<double> heights(const Response& response) {
  std::vector<double> list;
  const auto tin = nlohmann::json::parse(response.body);
  for (const auto& v : tin["vertices"]) list.push_back(v[2]);
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

// What touches in one corner has two heights there and no line for a wall: the result is a surface like any other.
TEST(MergeOperation, TilesThatTouchInACornerCanBeWorkedOn) {
  const Response merged = run("merge", {tile(square(0, 0, 2, 1), "a"), tile(square(2, 2, 2, 9), "b")});
  EXPECT_EQ(heights(merged), (std::vector<double>{1, 9}));
  EXPECT_EQ(run("convert", {{"surface", "m", "", merged.body}}, {}, "obj").body,
            run("merge", {tile(square(0, 0, 2, 1), "a"), tile(square(2, 2, 2, 9), "b")}, {}, "obj").body);
}

TEST(MergeOperation, MedianIsCertified) {
  const Response r =
      run("merge", {tile(square(0, 0, 2, 1), "a"), tile(square(0, 0, 2, 9), "b"), tile(square(0, 0, 2, 4), "c")},
          {{"overlap", "median"}});
  EXPECT_EQ(heights(r), std::vector<double>{4});
  EXPECT_EQ(r.report["accuracy"]["max_height_error"], 0.0);
  EXPECT_GT(r.report["accuracy"]["points_checked"], 0);
  EXPECT_EQ(r.report["seams"]["pairs"].size(), 3u);
}

TEST(MergeOperation, ANumberIsALevelOfMinAndMax) {
  const std::vector<InputPart> inputs{tile(square(0, 0, 2, 1), "a"), level("3"), tile(square(5, 0, 2, 8), "b")};
  EXPECT_EQ(heights(run("merge", inputs, {{"overlap", "max"}})), (std::vector<double>{3, 8}));
  EXPECT_EQ(heights(run("merge", inputs, {{"overlap", "min"}})), (std::vector<double>{1, 3}));
  EXPECT_EQ(run("merge", inputs, {{"overlap", "min"}}).report["inputs"][1]["level"], 3.0);
  EXPECT_EQ(heights(run("merge", {level("2"), tile(square(0, 0, 2, 1), "a"), level("4")}, {{"overlap", "max"}})),
            std::vector<double>{4});
  for (const char* overlap : {"first", "last", "mean", "median", "sum"}) {
    const Error error = refusal(inputs, {{"overlap", overlap}});
    EXPECT_EQ(error.kind, ErrorKind::usage) << overlap;
    EXPECT_EQ(error.code, "level-as-tile") << overlap;
  }
  EXPECT_EQ(refusal({level("3")}, {{"overlap", "max"}}).code, "missing-input");
}

TEST(MergeOperation, SnapAndGapAreReported) {
  const std::vector<InputPart> inputs{tile(square(0, 0, 2, 1), "a"), tile(square(2.01, 0.001, 2, 1), "b")};
  const Response apart = run("merge", inputs);
  EXPECT_EQ(apart.report["output"]["components"], 2);
  EXPECT_FALSE(apart.report.contains("snap"));
  const Response snapped = run("merge", inputs, {{"snap", "0.05"}});
  EXPECT_EQ(snapped.report["output"]["components"], 1);
  EXPECT_EQ(snapped.report["snap"]["moved"], 2);
  EXPECT_NEAR(snapped.report["snap"]["max_move"], std::hypot(0.01, 0.001), 1e-12);
  EXPECT_EQ(snapped.report["accuracy"]["max_height_error"], 0.0);
  const Response bridged = run("merge", inputs, {{"gap", "0.05"}});
  EXPECT_EQ(bridged.report["output"]["components"], 1);
  EXPECT_EQ(bridged.report["gap"]["slits"], 1);
  EXPECT_NEAR(bridged.report["gap"]["area_2d"], 0.02, 1e-4);
  EXPECT_NEAR(bridged.report["area_balance"]["residual"], 0, 1e-12);
}

TEST(MergeOperation, LengthsAreMetresWhereCoordinatesAreDegrees) {
  // A slit of 1e-5 degrees of longitude at 60 N is 0.56 m wide.
  const std::vector<InputPart> inputs{tile(square(10, 60, 0.001, 1, "EPSG:4326"), "a"),
                                      tile(square(10.00101, 60, 0.001, 1, "EPSG:4326"), "b")};
  EXPECT_EQ(run("merge", inputs, {{"gap", "0.5"}}).report["output"]["components"], 2);
  EXPECT_EQ(run("merge", inputs, {{"gap", "0.6"}}).report["output"]["components"], 1);
  EXPECT_EQ(run("merge", inputs, {{"snap", "0.5"}}).report["output"]["components"], 2);
  EXPECT_EQ(run("merge", inputs, {{"snap", "2ft"}}).report["output"]["components"], 1);
}

TEST(MergeOperation, WallOffsetLeavesOneHeightPerPlace) {
  const std::vector<InputPart> inputs{tile(square(0, 0, 2, 1), "a"), tile(square(1, 0, 2, 5), "b")};
  EXPECT_GT(run("merge", inputs).report["output"]["walls"], 0);
  const Response r = run("merge", inputs, {{"wall-offset", "0.01"}});
  EXPECT_EQ(r.report["output"]["walls"], 0);
  EXPECT_EQ(r.report["wall_offset"]["moved"], 3) << "the diagonal of b ends there, too";
  EXPECT_DOUBLE_EQ(r.report["output"]["area_2d"], 6);
  EXPECT_EQ(r.report["accuracy"]["max_height_error"], 0.0);
}

TEST(SeamsOperation, IsTheReportAlone) {
  const std::vector<InputPart> inputs{tile(square(0, 0, 2, 1), "a"), tile(square(1, 0, 2, 5), "b"),
                                      tile(square(3, 0, 2, 5), "c")};
  const Response r = run("seams", inputs);
  EXPECT_EQ(r.report["type"], "SeamReport");
  EXPECT_EQ(r.report["dz"], "b - a");
  ASSERT_EQ(r.report["pairs"].size(), 2u);
  EXPECT_EQ(r.report["pairs"][0]["kind"], "overlap");
  EXPECT_EQ(r.report["pairs"][0]["overlap"]["dz_mean"], 4.0);
  EXPECT_EQ(r.report["pairs"][1]["kind"], "border");
  EXPECT_EQ(r.report["pairs"], run("merge", inputs).report["seams"]["pairs"]);
}

TEST(SeamsOperation, LinesHaveTheirJumps) {
  const std::vector<InputPart> inputs{tile(square(0, 0, 2, 1), "a"), tile(square(1, 0, 2, 5), "b")};
  const auto lines = nlohmann::json::parse(run("seams", inputs, {}, "geojson").body);
  ASSERT_EQ(lines["features"].size(), 2u) << "the diagonal of b divides the seam";
  const auto& feature = lines["features"][0];
  EXPECT_EQ(feature["geometry"], (nlohmann::json{{"type", "LineString"}, {"coordinates", {{2.0, 0.0}, {2.0, 1.0}}}}));
  EXPECT_EQ(feature["properties"], (nlohmann::json{{"a", "a"},
                                                   {"b", "b"},
                                                   {"kind", "overlap"},
                                                   {"jump_start", 4.0},
                                                   {"jump_end", 4.0},
                                                   {"max_abs", 4.0},
                                                   {"length", 1.0}}));
}

TEST(SeamsOperation, NoJumpIsMinusZero) {
  const std::string tilted = R"({"type":"TIN","crs":"local:m","triangles":[[0,1,4],[1,2,4],[2,3,4]],
                                 "vertices":[[2,0,-1],[4,0,-1],[4,2,1],[2,2,1],[2,1,0]]})";
  const Response r = run("seams", {tile(square(0, 0, 2, 0), "a"), tile(tilted, "b")}, {}, "geojson");
  EXPECT_EQ(nlohmann::json::parse(r.body)["features"].size(), 2u);
  EXPECT_EQ(r.body.find("-0.0"), std::string::npos) << r.body;
}

TEST(SeamsOperation, ATileAloneHasNone) {
  EXPECT_TRUE(run("seams", {tile(square(0, 0, 2, 1), "a")}).report["pairs"].empty());
  EXPECT_TRUE(
      nlohmann::json::parse(run("seams", {tile(square(0, 0, 2, 1), "a")}, {}, "geojson").body)["features"].empty());
}

}  // namespace
}  // namespace terrane
