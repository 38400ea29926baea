// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "unit/ops/requests.hpp"

using namespace terrane;

namespace {

using Inputs = std::vector<InputPart>;

/// A dome whose level 50 is a ring about its middle.
std::string dome(double x, double y) {
  return lattice(20, x, y, 5, [](int i, int j) { return 100 - (i - 10) * (i - 10) - (j - 10) * (j - 10); });
}

const std::string a = run("threshold", {part("surface", dome(470000, 4380000))}, {{"level", "50"}}).body,
                  b = run("threshold", {part("surface", dome(470030, 4380010))}, {{"level", "20"}}).body;

void expect_sound(const Response& r) {
  EXPECT_EQ(r.report["topology"],
            nlohmann::json({{"inverted", 0}, {"degenerate", 0}, {"t_junctions", 0}, {"non_manifold_edges", 0}}));
  EXPECT_EQ(r.report["accuracy"]["max_height_error"], 0.0);
  EXPECT_GT(r.report["accuracy"]["points_checked"].get<int>(), 3);
  EXPECT_NEAR(r.report["area_balance"]["residual"].get<double>(), 0, 1e-6);
}

std::set<double> heights(const Response& r) {
  std::set<double> z;
  const auto tin = nlohmann::json::parse(r.body);
  for (const auto& v : tin["vertices"]) z.insert(v[2].get<double>());
  return z;
}

std::pair<nlohmann::json, nlohmann::json> mesh(const Response& r) {
  const auto tin = nlohmann::json::parse(r.body);
  return {tin["vertices"], tin["triangles"]};
}

}  // namespace

TEST(Threshold, IsCertified) {
  const Response r = run("threshold", {part("surface", dome(470000, 4380000))}, {{"level", "50.5"}});
  expect_sound(r);
  EXPECT_EQ(heights(r), (std::set<double>{0, 255}));
  EXPECT_GT(r.report["output"]["walls"].get<int>(), 20);
  EXPECT_DOUBLE_EQ(r.report["output"]["area_2d"].get<double>(), 10000);
  const auto& truth = r.report["truth"];
  EXPECT_NEAR(truth["true_2d"].get<double>() + truth["false_2d"].get<double>(), 10000, 1e-6);
  EXPECT_NEAR(truth["true_2d"].get<double>(), 3.14159 * 49.5 * 25, 40);
  EXPECT_FALSE(warned(r, "flat-at-level"));
}

TEST(Threshold, BelowIsTheNotOfAbove) {
  const Inputs surface = {part("surface", dome(470000, 4380000))};
  const Response above = run("threshold", surface, {{"level", "50"}}),
                 below = run("threshold", surface, {{"level", "50"}, {"true-when", "below"}});
  expect_sound(below);
  EXPECT_EQ(above.report["truth"]["true_2d"], below.report["truth"]["false_2d"]);
  EXPECT_EQ(run("xor", {part("a", above.body), part("b", below.body)}).report["truth"]["false_2d"], 0.0);
}

TEST(Threshold, FlatAreasAtTheLevelAreReported) {
  const std::string flat = lattice(4, 470000, 4380000, 10, [](int i, int) { return i < 2 ? 7 : 7 + i; });
  const Response r = run("threshold", {part("surface", flat)}, {{"level", "7"}});
  EXPECT_TRUE(warned(r, "flat-at-level"));
  EXPECT_EQ(r.report["flat_at_level"], nlohmann::json({{"faces", 8}, {"area_2d", 400.0}}));
  EXPECT_EQ(r.report["truth"]["true_2d"], 1600.0);
  EXPECT_EQ(
      run("threshold", {part("surface", flat)}, {{"level", "7"}, {"true-when", "below"}}).report["truth"]["true_2d"],
      0.0);
}

TEST(Threshold, TakesUnitsAndRefusesNonsense) {
  const Inputs surface = {part("surface", dome(470000, 4380000))};
  EXPECT_EQ(run("threshold", surface, {{"level", "100ft"}}).report["truth"],
            run("threshold", surface, {{"level", "30.48"}}).report["truth"]);
  EXPECT_EQ(refusal("threshold", surface).code, "missing-parameter");
  EXPECT_EQ(refusal("threshold", surface, {{"level", "5"}, {"z-true", "0"}}).kind, ErrorKind::usage);
  EXPECT_EQ(refusal("threshold", surface, {{"level", "high"}}).kind, ErrorKind::usage);
}

TEST(Quantize, MakesTerraces) {
  const Inputs surface = {part("surface", dome(470000, 4380000))};
  const Response r = run("quantize", surface, {{"interval", "30"}, {"base", "5"}});
  expect_sound(r);
  EXPECT_EQ(heights(r), (std::set<double>{-115, -85, -55, -25, 5, 35, 65, 95}));
  const Response listed = run("quantize", surface, {{"levels", "60,0,30"}});
  expect_sound(listed);
  EXPECT_EQ(heights(listed), (std::set<double>{0, 30, 60})) << "below the first level is the first";
  EXPECT_EQ(heights(run("quantize", surface, {{"levels", "0:60:30"}})), heights(listed));
  EXPECT_EQ(heights(run("quantize", surface, {{"levels", "500"}})), (std::set<double>{500}));
}

TEST(Quantize, RefusesNonsense) {
  const Inputs surface = {part("surface", dome(470000, 4380000))};
  EXPECT_EQ(refusal("quantize", surface).code, "missing-parameter");
  EXPECT_EQ(refusal("quantize", surface, {{"interval", "5"}, {"levels", "1,2"}}).code, "surplus-parameter");
  EXPECT_EQ(refusal("quantize", surface, {{"interval", "0"}}).kind, ErrorKind::usage);
  EXPECT_EQ(refusal("quantize", surface, {{"interval", "-1"}}).kind, ErrorKind::usage);
  EXPECT_EQ(refusal("quantize", surface, {{"interval", "1e-9"}}).code, "too-many-levels");
  EXPECT_EQ(refusal("quantize", surface, {{"levels", "0,1,1.0000000001"}}).code, "levels-too-close");
}

TEST(Logic, IsCertified) {
  for (const char* operation : {"and", "or", "xor", "nand", "nor"})
    for (const char* extent : {"overlap", "box"}) {
      SCOPED_TRACE(std::string(operation) + " " + extent);
      const Response r = run(operation, {part("a", a), part("b", b)}, {{"extent", extent}, {"z-true", "1"}});
      expect_sound(r);
      EXPECT_EQ(heights(r), (std::set<double>{0, 1}));
      const double whole = extent == std::string("box") ? 130 * 110 : 70 * 90;
      EXPECT_NEAR(r.report["output"]["area_2d"].get<double>(), whole, 1e-6);
      const Response swapped = run(operation, {part("a", b), part("b", a)}, {{"extent", extent}, {"z-true", "1"}});
      EXPECT_TRUE(mesh(r) == mesh(swapped));
    }
}

TEST(Logic, NotOfNotIsTheSameSurface) {
  const Response once = run("threshold", {part("surface", dome(470000, 4380000))}, {{"level", "50"}}),
                 twice = run("not", {part("a", run("not", {part("a", once.body)}).body)});
  expect_sound(twice);
  EXPECT_TRUE(mesh(once) == mesh(twice));
  const Response odd = run("not",
                           {part("a", run("threshold", {part("surface", dome(470000, 4380000))},
                                          {{"level", "50"}, {"z-false", "0.1"}, {"z-true", "0.7"}})
                                          .body)},
                           {{"z-false", "0.1"}, {"z-true", "0.7"}});
  EXPECT_EQ(heights(odd), (std::set<double>{0.1, 0.7})) << "though 0.1 + 0.7 - 0.1 is not 0.7 in doubles";
  expect_sound(run("not", {part("a", dome(470000, 4380000))}));
}

TEST(Logic, RefusesWhatIsNotBinaryAndWhatDoesNotOverlap) {
  const Error grey = refusal("and", {part("a", a), part("b", dome(470000, 4380000))});
  EXPECT_EQ(grey.kind, ErrorKind::input);
  EXPECT_EQ(grey.code, "not-binary");
  for (const char* word : {"'b.json'", "face ", "threshold"})
    EXPECT_NE(std::string(grey.what()).find(word), std::string::npos) << grey.what();
  const std::string far = run("threshold", {part("surface", dome(480000, 4380000))}, {{"level", "50"}}).body;
  const Error apart = refusal("or", {part("a", a), part("b", far)});
  EXPECT_EQ(apart.code, "no-overlap");
  EXPECT_NE(std::string(apart.what()).find("extent=box"), std::string::npos);
  expect_sound(run("or", {part("a", a), part("b", far)}, {{"extent", "box"}}));
  EXPECT_EQ(refusal("or", {part("a", a), part("b", b)}, {{"z-true", "-1"}}).kind, ErrorKind::usage);
}

TEST(Logic, SlopesOfDegreesAreMeasuredInMetres) {
  // From 0 to 255 over 0.0005 degrees, some 40 m: 81 degrees steep.
  const std::string cell = lattice(
      2, 3, 39, 0.0005, [](int i, int) { return i == 0 ? 0 : 255; }, "EPSG:4326");
  EXPECT_EQ(refusal("and", {part("a", cell), part("b", cell)}).code, "not-binary");
  const Response r = run("threshold", {part("surface", cell)}, {{"level", "100"}});
  expect_sound(r);
  expect_sound(run("or", {part("a", r.body), part("b", r.body)}));
}
