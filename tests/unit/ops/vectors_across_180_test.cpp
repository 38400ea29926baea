// SPDX-License-Identifier: GPL-3.0-or-later
// Regions in longitudes and latitudes over surfaces in other CRSs that lie across 180 degrees.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "io/geodesy.hpp"
#include "ops/operation.hpp"
#include "ops/request.hpp"

namespace terrane {
namespace {

/// n x n cells from 179.3 to 180.7 degrees in a CRS, as it has them.
InputPart around_180(const std::string& crs) {
  constexpr int n = 20;
  std::vector<Point> corners = {{179.3, -17.3, 0}, {-179.3, -16.3, 0}};
  if (crs == "OGC:CRS84") corners[1].x = 180.7;
  transform_points(corners, Crs::parse("OGC:CRS84"), Crs::parse(crs));
  nlohmann::json tin = {{"type", "TIN"}, {"crs", crs}};
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      tin["vertices"].push_back({corners[0].x + (corners[1].x - corners[0].x) * i / n,
                                 corners[0].y + (corners[1].y - corners[0].y) * j / n, i + j});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i;
      tin["triangles"].push_back({a, a + 1, a + n + 2});
      tin["triangles"].push_back({a, a + n + 2, a + n + 1});
    }
  return {"surface", "s.json", "", tin.dump()};
}

/// Quadrilaterals from one longitude to another.
using Spans = std::vector<std::pair<double, double>>;

Response clipped(const InputPart& surface, const Spans& spans, bool degrees_beyond_180 = false) {
  nlohmann::json polygons = nlohmann::json::array();
  for (const auto& [west, east] : spans) {
    nlohmann::json ring = nlohmann::json::array();
    for (const Point2 p : {Point2{west, -17}, {east, -17}, {east, -16.6}, {west, -16.6}, {west, -17}})
      ring.push_back({p.x, p.y});
    polygons.push_back(nlohmann::json::array({ring}));
  }
  Request request;
  request.operation = "clip";
  request.inputs = {surface};
  request.parameters = {{"region", nlohmann::json{{"type", "MultiPolygon"}, {"coordinates", polygons}}.dump()}};
  if (degrees_beyond_180) request.parameters.emplace_back("region-crs", "OGC:CRS84");
  request.format = "json";
  Context context;
  return execute(plan(request), context);
}

double area(const Response& r) { return r.report["output"]["area_2d"]; }

bool warned(const Response& r) {
  return std::any_of(r.warnings.begin(), r.warnings.end(), [](const Warning& w) { return w.code == "long-way-round"; });
}

/// How near two vertices are to each other.
double least_distance(const Response& r) {
  const auto vertices = nlohmann::json::parse(r.body)["vertices"].get<std::vector<std::array<double, 3>>>();
  double least = INFINITY;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      least = std::min(least, std::hypot(vertices[i][0] - vertices[j][0], vertices[i][1] - vertices[j][1]));
  return least;
}

TEST(VectorsAcross180, HalvesBecomeOneInEveryProjectionThatGoesOnThere) {
  for (const char* crs : {"EPSG:3832", "EPSG:32760", "EPSG:32701"}) {
    SCOPED_TRACE(crs);
    const InputPart surface = around_180(crs);
    const Response both = clipped(surface, {{179.8, 180}, {-180, -179.9}});
    EXPECT_EQ(both.report["output"]["components"], 1);
    EXPECT_GT(least_distance(both), 0.01) << "a slit along 180 degrees";
    const double east = area(clipped(surface, {{-180, -179.9}})), west = area(clipped(surface, {{179.8, 180}}));
    EXPECT_NEAR(area(both), west + east, 1e-3);
    // In one piece its edges bend a little otherwise.
    for (const auto& [from, to] : {std::pair{179.8, 180.1}, std::pair{-180.2, -179.9}, std::pair{179.8, -179.9}}) {
      const Response whole = clipped(surface, {{from, to}}, true);
      EXPECT_NEAR(area(whole), area(both), 1e-4 * area(both));
      EXPECT_FALSE(warned(whole));
    }
  }
}

TEST(VectorsAcross180, WhatAProjectionTearsApartIsRefused) {
  // Up to where web Mercator ends.
  nlohmann::json tin = {{"type", "TIN"}, {"crs", "EPSG:3857"}, {"triangles", {{0, 1, 2}}}};
  tin["vertices"] = {{19950000, -1950000, 0}, {20037508, -1950000, 0}, {20037508, -1850000, 0}};
  const InputPart mercator = {"surface", "s.json", "", tin.dump()};
  try {
    clipped(mercator, {{179.8, 180.1}}, true);
    ADD_FAILURE() << "torn apart";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, "outside-crs");
    EXPECT_NE(std::string(error.what()).find("between 179.8, -17.0 and 180.1, -17.0"), std::string::npos);
  }
  EXPECT_EQ(area(clipped(mercator, {{179.8, 180}, {-180, -179.9}})), area(clipped(mercator, {{179.8, 180}})));
  // The whole globe is in one piece.
  EXPECT_GT(area(clipped(mercator, {{-180, 180}})), area(clipped(mercator, {{179.8, 180}})));
}

TEST(VectorsAcross180, TheLongWayRoundIsTold) {
  const InputPart degrees = around_180("OGC:CRS84");
  EXPECT_TRUE(warned(clipped(degrees, {{179.8, -179.9}})));
  EXPECT_FALSE(warned(clipped(degrees, {{179.8, 180}, {-180, -179.9}})));
  EXPECT_FALSE(warned(clipped(degrees, {{-180, 180}})));
}

}  // namespace
}  // namespace terrane
