// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/error.hpp"
#include "ops/operation.hpp"
#include "ops/outcome.hpp"

// Points through the whole flow of a request.
namespace terrane {
namespace {

Response triangulated(const std::string& table, std::vector<std::pair<std::string, std::string>> parameters) {
  Request request;
  request.operation = "triangulate";
  request.inputs.push_back({"points", "survey.csv", "", table});
  request.parameters = std::move(parameters);
  request.parameters.emplace_back("crs", "EPSG:25831");
  Context context;
  return execute(plan(std::move(request)), context);
}

ErrorKind refusal(const std::string& table, std::vector<std::pair<std::string, std::string>> parameters) {
  try {
    triangulated(table, std::move(parameters));
  } catch (const Error& error) {
    return error.kind;
  }
  return ErrorKind::internal;
}

/// A wavy 21 x 21 lattice of points, a metre apart.
std::string lattice() {
  std::string table = "name,easting,northing,elevation\n";
  for (int j = 0; j <= 20; ++j)
    for (int i = 0; i <= 20; ++i)
      table += "p," + std::to_string(500000 + i) + "," + std::to_string(4500000 + j) + "," +
               std::to_string(10 + std::sin(0.3 * i) + 0.1 * (i * 7 % 3)) + "\n";
  return table;
}

TEST(TriangulateOperation, PointsBecomeASurface) {
  const auto report = triangulated(lattice(), {}).report;
  EXPECT_EQ(report["output"]["vertices"], 441);
  EXPECT_EQ(report["output"]["faces"], 800);
  EXPECT_EQ(report["points"]["read"], 441);
}

TEST(TriangulateOperation, TheBoundaryAndTheBoundHold) {
  const auto report =
      triangulated(lattice(), {{"boundary", "500002.5,4500002;500018,4500002;500018,4500018"}, {"max-error", "0.2"}})
          .report;
  EXPECT_NEAR(report["output"]["area_2d"].get<double>(), 15.5 * 16 / 2, 1e-6);
  EXPECT_LE(report["accuracy"]["approximation"]["measured"].get<double>(), 0.2);
  EXPECT_LT(report["output"]["faces"].get<int>(), 200);
}

TEST(TriangulateOperation, BreaklinesComeFromText) {
  const auto report =
      triangulated(lattice(), {{"breaklines", "LINESTRING Z (500000 4500000.5 9, 500020 4500010.5 12)"}}).report;
  EXPECT_EQ(report["output"]["vertices"], 443);
}

TEST(TriangulateOperation, WhatDoesNotFitIsRefused) {
  EXPECT_EQ(refusal(lattice(), {{"boundary", "0,0;1,0;1,1"}}), ErrorKind::input);
  EXPECT_EQ(refusal(lattice(), {{"max-edge", "0.1"}}), ErrorKind::input);
  EXPECT_EQ(refusal(lattice(), {{"classes", "2.5"}}), ErrorKind::usage);
  EXPECT_EQ(refusal(lattice(), {{"columns", "AB"}}), ErrorKind::usage);
  EXPECT_EQ(refusal("1,1,1\n1,1,2\n3,3,3\n", {}), ErrorKind::input);
  Request surface;
  surface.operation = "info";
  surface.inputs.push_back({"surface", "survey.csv", "", lattice()});
  Context context;
  EXPECT_THROW(execute(plan(std::move(surface)), context), Error);
}

}  // namespace
}  // namespace terrane
