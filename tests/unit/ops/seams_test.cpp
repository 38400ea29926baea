// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <string>

#include "core/error.hpp"
#include "ops/operation.hpp"
#include "ops/request.hpp"

// Ramps and blends through the request path: what users are told of them.
namespace terrane {
namespace {

/// A grid of `columns` by `rows` samples a unit apart, all of one height.
InputPart grid(const std::string& slot, const std::string& name, double west, double south, int columns, int rows,
               int height) {
  std::string text = "ncols " + std::to_string(columns) + "\nnrows " + std::to_string(rows) + "\nxllcenter " +
                     std::to_string(west) + "\nyllcenter " + std::to_string(south) + "\ncellsize 1\n";
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) text += std::to_string(height) + " ";
    text += "\n";
  }
  return {slot, name, "", text};
}

Response run(const std::string& operation, std::vector<InputPart> inputs,
             std::vector<std::pair<std::string, std::string>> parameters) {
  Context context;
  parameters.emplace_back("crs", "EPSG:25831");
  return execute(plan({.operation = operation, .inputs = std::move(inputs), .parameters = std::move(parameters)}),
                 context);
}

std::vector<InputPart> tiles(double west = 4.5) {
  return {grid("tiles", "a.asc", 0, 0, 9, 9, 3), grid("tiles", "b.asc", west, 0.5, 9, 8, 5)};
}

TEST(Seams, RampsAreSaidToBeWhereNoHeightIsPromised) {
  for (const std::string operation : {"add", "merge"}) {
    auto inputs = tiles();
    if (operation == "add") inputs[0].slot = "a", inputs[1].slot = "b";
    const auto sum = operation == "merge" ? std::vector<std::pair<std::string, std::string>>{{"overlap", "sum"}}
                                          : std::vector<std::pair<std::string, std::string>>{};
    auto with_ramp = sum;
    with_ramp.emplace_back("seam", "ramp");
    const Response walls = run(operation, inputs, sum), ramps = run(operation, inputs, with_ramp);
    EXPECT_GT(walls.report["output"]["walls"], 0);
    EXPECT_FALSE(walls.report.contains("ramps"));
    EXPECT_EQ(ramps.report["output"]["walls"], 0);
    EXPECT_GT(ramps.report["ramps"]["area_2d"], 1);
    EXPECT_LT(ramps.report["accuracy"]["max_height_error"], 1e-9);
    EXPECT_GT(ramps.report["accuracy"]["points_checked"], 20);
    EXPECT_NEAR(ramps.report["area_balance"]["residual"].get<double>(), 0, 1e-9);
    for (const auto& [what, count] : ramps.report["topology"].items()) EXPECT_EQ(count, 0) << what;
  }
}

TEST(Seams, ADifferenceIsRampedWhereTheMissingOneIsZero) {
  auto inputs = tiles();
  inputs[0].slot = "minuend", inputs[1].slot = "subtrahend";
  const Response made = run("subtract", inputs, {{"outside", "zero"}, {"seam", "ramp"}});
  EXPECT_EQ(made.report["output"]["walls"], 0);
  EXPECT_GT(made.report["ramps"]["faces"], 0);
}

TEST(Seams, ABlendSaysHowNearItComes) {
  const Response made =
      run("merge", tiles(), {{"overlap", "blend"}, {"blend-width", "2"}, {"blend-tolerance", "0.05"}});
  const auto& blend = made.report["accuracy"]["approximation"]["blend"];
  EXPECT_EQ(blend["tolerance"], 0.05);
  EXPECT_LE(blend["bound"], 0.05);
  EXPECT_EQ(blend["unresolved"]["places"], 2);
  EXPECT_GT(blend["vertices_made"], 10);
  EXPECT_LT(made.report["accuracy"]["max_height_error"], 1e-9);
  for (const auto& [what, count] : made.report["topology"].items()) EXPECT_EQ(count, 0) << what;
}

TEST(Seams, BentSurfacesHaveNoWalls) {
  for (const std::string side : {"inside", "outside"})
    for (const double west : {4.5, 8.0}) {
      SCOPED_TRACE(side);
      const Response made =
          run("merge", tiles(west), {{"overlap", "blend"}, {"blend-width", "2"}, {"blend-side", side}});
      EXPECT_EQ(made.report["output"]["walls"], 0);
      EXPECT_GT(made.report["bent"]["area_2d"], 1);
      EXPECT_LT(made.report["accuracy"]["max_height_error"], 1e-9);
    }
}

TEST(Seams, ABlendNeedsAWidthAndATolerance) {
  for (const auto& [name, value] : {std::pair("blend-width", "0"), std::pair("blend-tolerance", "0")}) {
    try {
      run("merge", tiles(), {{"overlap", "blend"}, {"blend-width", "2"}, {name, value}});
      FAIL() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind, ErrorKind::usage) << error.what();
    }
  }
}

}  // namespace
}  // namespace terrane
