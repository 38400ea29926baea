// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "unit/ops/requests.hpp"

using namespace terrane;

namespace {

std::string grid(int n, int (*height)(int i, int j, int n)) {
  std::string text = "ncols " + std::to_string(n) + "\nnrows " + std::to_string(n) +
                     "\nxllcenter 500000\nyllcenter 4500000\ncellsize 10\n";
  for (int j = 0; j < n; ++j, text += "\n")
    for (int i = 0; i < n; ++i) text += std::to_string(height(i, j, n)) + " ";
  return text;
}

/// n x n samples, 10 m apart and 1 m high for each of the steps from the border.
std::string hill(int n) {
  return grid(n, [](int i, int j, int n) { return std::min({i, j, n - 1 - i, n - 1 - j}); });
}

/// The same for the steps from the western and eastern border: two planes.
std::string roof(int n) {
  return grid(n, [](int i, int, int n) { return std::min(i, n - 1 - i); });
}

Response run(const std::string& operation, const std::string& bytes, Parameters parameters,
             const std::string& format = "", const std::string& name = "surface.asc") {
  parameters.emplace_back("assume-crs", "EPSG:25831");
  return terrane::run(operation, {{"surface", name, "", bytes}}, std::move(parameters), format);
}

Error refused(const std::string& operation, Parameters parameters) {
  return refusal_of([&] { run(operation, hill(5), std::move(parameters)); });
}

std::size_t faces(const Response& made) { return made.report["output"]["faces"]; }

}  // namespace

TEST(SimplifyOperation, ReportsTheBoundAndWhatWasReached) {
  const Response made = run("simplify", hill(21), {{"max-error", "0.5"}}, "json");
  EXPECT_LT(faces(made), 800u);
  EXPECT_EQ(made.report["inputs"][0]["faces"], 800) << "max-error is not spent on the raster";
  const auto accuracy = made.report["accuracy"]["approximation"];
  EXPECT_EQ(accuracy["max_error"], 0.5);
  EXPECT_LE(accuracy["measured"].get<double>(), 0.5);
  EXPECT_GT(accuracy["measured"].get<double>(), 0);
  EXPECT_NEAR(accuracy["on_overlay"].get<double>(), accuracy["measured"].get<double>(), 1e-8);
  EXPECT_EQ(made.report["area_balance"]["residual"], 0);
  EXPECT_EQ(made.report["accuracy"]["max_height_error"], 0);
}

TEST(SimplifyOperation, LengthsMayHaveUnits) {
  const Response made = run("simplify", hill(21), {{"max-error", "10ft"}});
  EXPECT_NEAR(made.report["accuracy"]["approximation"]["max_error"].get<double>(), 3.048, 1e-12);
}

TEST(SimplifyOperation, CoplanarFacesGo) {
  const Response made = run("simplify", roof(21), {{"coplanar-only", "true"}});
  EXPECT_EQ(faces(made), 78u) << "the border alone is left";
  EXPECT_LT(made.report["accuracy"]["approximation"]["measured"].get<double>(), 1e-9);
  const Response free = run("simplify", roof(21), {{"coplanar-only", "true"}, {"keep-boundary", "false"}});
  EXPECT_EQ(faces(free), 4u);
}

TEST(SimplifyOperation, ANumberOfFaces) {
  const Response made = run("simplify", hill(21), {{"max-triangles", "200"}});
  EXPECT_LE(faces(made), 200u);
  EXPECT_TRUE(made.report["accuracy"]["approximation"]["max_error"].is_null());
  const Response few = run("simplify", hill(21), {{"max-triangles", "10"}});
  EXPECT_EQ(faces(few), 78u) << "the border alone";
  EXPECT_TRUE(warned(few, "max-triangles-not-reached"));
}

TEST(SimplifyOperation, ContradictionsAreRefusedBeforeAnythingIsRead) {
  EXPECT_EQ(refused("simplify", {}).code, "missing-parameter");
  EXPECT_EQ(refused("simplify", {{"coplanar-only", "true"}, {"max-error", "1"}}).code, "surplus-parameter");
  EXPECT_EQ(refused("simplify", {{"max-error", "-1"}}).kind, ErrorKind::usage);
  EXPECT_EQ(refused("simplify", {{"max-triangles", "0"}}).kind, ErrorKind::usage);
}

TEST(ContourOperation, LinesWithTheirLevels) {
  const Response made = run("contour", hill(21), {{"interval", "2"}, {"base", "1"}});
  EXPECT_EQ(made.media_type, "application/geo+json");
  const auto lines = nlohmann::json::parse(made.body);
  ASSERT_EQ(lines["features"].size(), 5u) << "1, 3, 5, 7, 9";
  double level = 1;
  for (const auto& feature : lines["features"]) {
    EXPECT_EQ(feature["properties"]["level"], level);
    const auto& line = feature["geometry"];
    EXPECT_EQ(line["type"], "LineString");
    EXPECT_EQ(line["coordinates"].front(), line["coordinates"].back());
    for (const auto& p : line["coordinates"]) EXPECT_EQ(p[2], level);
    level += 2;
  }
  EXPECT_EQ(made.report["contours"]["levels"], 5);
  EXPECT_EQ(made.report["contours"]["closed"], 5);
  for (const char* format : {"gpkg", "dxf"})
    EXPECT_FALSE(run("contour", hill(21), {{"interval", "2"}}, format).body.empty());
}

TEST(ContourOperation, LevelsInAnyOrder) {
  const auto lines = nlohmann::json::parse(run("contour", hill(21), {{"levels", "4.5,2,4.5,100"}}).body);
  ASSERT_EQ(lines["features"].size(), 2u);
  EXPECT_EQ(lines["features"][0]["properties"]["level"], 2);
  EXPECT_EQ(nlohmann::json::parse(run("contour", hill(21), {{"levels", "1:9:2"}}).body)["features"].size(), 5u);
}

TEST(ContourOperation, BadParametersAreRefused) {
  EXPECT_EQ(refused("contour", {}).code, "missing-parameter");
  EXPECT_EQ(refused("contour", {{"interval", "1"}, {"levels", "3"}}).code, "surplus-parameter");
  EXPECT_EQ(refused("contour", {{"interval", "0"}}).code, "bad-parameter");
  EXPECT_EQ(refused("contour", {{"levels", "high"}}).kind, ErrorKind::usage);
  EXPECT_EQ(refused("contour", {{"interval", "1e-9"}}).code, "too-many-levels");
  EXPECT_TRUE(warned(run("contour", hill(5), {{"levels", "50"}}), "no-contours"));
}
