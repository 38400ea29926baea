// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "unit/ops/requests.hpp"

// clip and synthesize-* through plan and execute, as the doors call them.
namespace terrane {
namespace {

/// 10 x 10 cells of 10 m, z = x / 10.
InputPart slope(const std::string& crs = "EPSG:25831") {
  return {"surface", "slope.json", "", lattice(10, 500000, 4600000, 10, [](int i, int) { return i; }, crs)};
}

void expect_exact(const Response& r, double area) {
  EXPECT_NEAR(r.report["output"]["area_2d"].get<double>(), area, 1e-6);
  EXPECT_NEAR(r.report["area_balance"]["residual"].get<double>(), 0, 1e-6);
  EXPECT_LT(r.report["accuracy"]["max_height_error"].get<double>(), 1e-9);
  EXPECT_GT(r.report["accuracy"]["points_checked"].get<int>(), 0);
  for (const char* key : {"inverted", "degenerate", "t_junctions", "non_manifold_edges"})
    EXPECT_EQ(r.report["topology"][key], 0);
}

TEST(ClipOperation, BoxesAndPolygonsOnBothSides) {
  const Parameters box = {{"bbox", "500015,4600025,500055,4600085"}};
  expect_exact(run("clip", {slope()}, box), 2400);
  Parameters outside = box;
  outside.emplace_back("side", "outside");
  expect_exact(run("clip", {slope()}, outside), 7600);
  const std::string wkt =
      "POLYGON((500010 4600010, 500090 4600010, 500090 4600090, 500010 4600090, 500010 4600010),"
      "(500033 4600033, 500033 4600066, 500066 4600066, 500066 4600033, 500033 4600033))";
  expect_exact(run("clip", {slope()}, {{"region", wkt}}), 6400 - 33 * 33);
  const std::string two =
      "MULTIPOLYGON(((500010 4600010, 500020 4600010, 500020 4600020, 500010 4600010)),"
      "((500050 4600050, 500150 4600050, 500150 4600150, 500050 4600150, 500050 4600050)))";
  expect_exact(run("clip", {slope()}, {{"region", two}}), 50 + 2500);
}

TEST(ClipOperation, CornersWrittenOutAndClosedLinesAreRings) {
  expect_exact(run("clip", {slope()}, {{"region", "500010,4600010;500030,4600010;500030,4600030"}}), 200);
  expect_exact(run("clip", {slope()},
                   {{"region", "LINESTRING(500010 4600010, 500030 4600010, 500030 4600030, 500010 4600010)"}}),
               200);
  EXPECT_EQ(refusal("clip", {slope()}, {{"region", "POINT(500010 4600010)"}}).code, "no-polygons");
  EXPECT_EQ(refusal("clip", {slope()}, {{"region", "500010,4600010;500020,4600020;500030,4600030"}}).code,
            "empty-region");
}

TEST(ClipOperation, GeoJsonIsInDegreesUnlessItSaysOtherwise) {
  const std::string crs = R"("crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::25831"}},)";
  const std::string ring =
      R"("coordinates":[[[500010,4600010],[500050,4600010],[500050,4600050],[500010,4600050],[500010,4600010]]]})";
  expect_exact(run("clip", {slope()}, {{"region", "{" + crs + R"("type":"Polygon",)" + ring}}), 1600);
  expect_exact(run("clip", {slope()}, {{"region", R"({"type":"Polygon",)" + ring}, {"region-crs", "EPSG:25831"}}),
               1600);
  EXPECT_EQ(refusal("clip", {slope()}, {{"region", R"({"type":"Polygon",)" + ring}}).code, "not-degrees");
}

TEST(ClipOperation, NothingInCommonSaysHowFarApart) {
  const Error apart = refusal("clip", {slope()}, {{"bbox", "501100,4600000,501200,4600100"}});
  EXPECT_EQ(apart.kind, ErrorKind::input);
  EXPECT_EQ(apart.code, "no-overlap");
  EXPECT_TRUE(says(apart, "about 1000 m apart")) << apart.what();
  const Response empty = run("clip", {slope()}, {{"bbox", "501100,4600000,501200,4600100"}, {"allow-empty", "true"}});
  EXPECT_TRUE(warned(empty, "no-overlap"));
  EXPECT_EQ(empty.report["output"]["faces"], 0);
  EXPECT_EQ(refusal("clip", {slope()}, {{"bbox", "400000,4500000,600000,4700000"}, {"side", "outside"}}).code,
            "nothing-left");
  EXPECT_TRUE(
      warned(run("clip", {slope()}, {{"bbox", "501100,4600000,501200,4600100"}, {"side", "outside"}}), "no-overlap"));
}

TEST(ClipOperation, WhatIsAskedForMustMakeSense) {
  for (const Parameters& p : std::vector<Parameters>{{},
                                                     {{"bbox", "1,2,3"}},
                                                     {{"bbox", "3,0,1,1"}},
                                                     {{"bbox", "0,0,0,1"}},
                                                     {{"bbox", "0,0,1,1"}, {"region", "0,0;1,0;1,1"}},
                                                     {{"bbox", "0,0,1,1"}, {"side", "left"}},
                                                     {{"region", "nonsense"}}})
    EXPECT_EQ(refusal("clip", {slope()}, p).kind, ErrorKind::usage);
}

TEST(ClipOperation, ARegionThatCrossesItselfIsWarnedOf) {
  const Response r =
      run("clip", {slope()},
          {{"region", "POLYGON((500010 4600010, 500030 4600030, 500030 4600010, 500010 4600030, 500010 4600010))"}});
  EXPECT_TRUE(warned(r, "region-crosses-itself"));
  expect_exact(r, 200);
}

double area(const Response& r) { return r.report["output"]["area_2d"].get<double>(); }

TEST(SynthesizeOperations, Rectangles) {
  const Response ramp = run("synthesize-rectangle", {},
                            {{"xmin", "-10"},
                             {"ymin", "0"},
                             {"xmax", "30"},
                             {"ymax", "20"},
                             {"zmin", "5"},
                             {"zmax", "9"},
                             {"crs", "EPSG:25831"}});
  EXPECT_EQ(ramp.report["output"]["faces"], 2);
  EXPECT_EQ(ramp.report["output"]["crs"], "EPSG:25831");
  EXPECT_DOUBLE_EQ(area(ramp), 800);
  EXPECT_EQ(ramp.report["area_balance"]["residual"], 0);
  const Parameters fine = {{"xmin", "0"},  {"ymin", "0"},     {"xmax", "10"},
                           {"ymax", "10"}, {"max-edge", "2"}, {"crs", "local:m"}};
  EXPECT_EQ(run("synthesize-rectangle", {}, fine).report["output"]["faces"], 128);
  EXPECT_TRUE(says(refusal("synthesize-rectangle", {}, {{"xmin", "0"}, {"ymax", "1"}}), "ymin, xmax"));
  EXPECT_EQ(refusal("synthesize-rectangle", {}, {{"xmin", "5"}, {"ymin", "0"}, {"xmax", "1"}, {"ymax", "1"}}).kind,
            ErrorKind::usage);
}

TEST(SynthesizeOperations, CirclesAndEllipses) {
  const Response circle =
      run("synthesize-circle", {}, {{"center", "100,200"}, {"radius", "10"}, {"z", "3"}, {"crs", "local:m"}});
  EXPECT_EQ(circle.report["output"]["vertices"], 64);
  EXPECT_NEAR(area(circle), 50 * 64 * std::sin(2 * std::numbers::pi / 64), 1e-9);
  EXPECT_GT(circle.report["accuracy"]["points_checked"].get<int>(), 0);
  EXPECT_FALSE(warned(circle, "few-samples"));
  EXPECT_TRUE(
      warned(run("synthesize-circle", {}, {{"center", "0,0"}, {"radius", "1"}, {"samples", "14"}}), "few-samples"));
  EXPECT_EQ(refusal("synthesize-circle", {}, {{"center", "0,0"}, {"radius", "1"}, {"samples", "2"}}).kind,
            ErrorKind::usage);
  EXPECT_EQ(refusal("synthesize-circle", {}, {{"center", "0,0"}, {"radius", "0"}}).kind, ErrorKind::usage);
  EXPECT_EQ(refusal("synthesize-circle", {}, {{"center", "0"}, {"radius", "1"}}).kind, ErrorKind::usage);
  EXPECT_EQ(refusal("synthesize-circle", {}, {{"center", "0,0"}, {"radius", "1"}, {"target-crs", "EPSG:4326"}}).kind,
            ErrorKind::usage);
  const Response ellipse = run("synthesize-ellipse", {},
                               {{"center", "0,0"},
                                {"major-axis", "20"},
                                {"minor-axis", "10"},
                                {"azimuth", "30"},
                                {"samples", "1000"},
                                {"crs", "local:m"}});
  EXPECT_NEAR(area(ellipse), 50 * std::numbers::pi, 0.01);
  const Response along_x = run("synthesize-ellipse", {},
                               {{"center", "0,0"}, {"major-axis", "20"}, {"minor-axis", "10"}, {"samples", "4"}});
  EXPECT_NE(along_x.body.find("[10,0,0]"), std::string::npos) << along_x.body;
  EXPECT_EQ(refusal("synthesize-ellipse", {}, {{"center", "0,0"}, {"major-axis", "1"}, {"minor-axis", "2"}}).kind,
            ErrorKind::usage);
  const Response feet =
      run("synthesize-circle", {}, {{"center", "0,0"}, {"radius", "100ft"}, {"samples", "1000"}, {"crs", "local:m"}});
  EXPECT_NEAR(area(feet), std::numbers::pi * 30.48 * 30.48, 0.1);
}

TEST(SynthesizeOperations, CirclesInDegreesAreRoundOnTheGround) {
  const Response r = run("synthesize-circle", {},
                         {{"center", "2.1,41.4"}, {"radius", "1000"}, {"samples", "1000"}, {"crs", "EPSG:4326"}});
  EXPECT_NEAR(area(r), std::numbers::pi * 1e6, 50);  // m2 on the ellipsoid
  EXPECT_EQ(refusal("synthesize-circle", {}, {{"center", "0,89.999"}, {"radius", "1000"}, {"crs", "EPSG:4326"}}).kind,
            ErrorKind::usage);
}

TEST(SynthesizeOperations, FreeForms) {
  const std::string square = "0,0;10,0;10,10;0,10";
  const Response curve = run("synthesize-polygon", {}, {{"points", square}, {"z", "2"}, {"crs", "local:m"}});
  EXPECT_EQ(curve.report["output"]["vertices"], 64);
  EXPECT_GT(area(curve), 140);
  EXPECT_LT(area(curve), 160);
  EXPECT_DOUBLE_EQ(area(run("synthesize-polygon", {}, {{"points", square}, {"spline", "false"}, {"crs", "local:m"}})),
                   100);
  EXPECT_EQ(run("synthesize-polygon", {}, {{"points", square}, {"samples", "200"}, {"crs", "local:m"}})
                .report["output"]["vertices"],
            200);
  const Error crossing = refusal("synthesize-polygon", {}, {{"points", "0,0;10,10;10,0;0,10"}, {"spline", "false"}});
  EXPECT_EQ(crossing.kind, ErrorKind::input);
  EXPECT_TRUE(says(crossing, "at 5.0, 5.0")) << crossing.what();
  EXPECT_EQ(refusal("synthesize-polygon", {}, {{"points", "0,0;10,10;10,0;0,10"}}).code, "crosses-itself");
  EXPECT_EQ(refusal("synthesize-polygon", {}, {{"points", "0,0;10,10;0,0"}}).code, "too-few-points");
  EXPECT_EQ(refusal("synthesize-polygon", {}, {{"points", "0,0;5,5;10,10"}, {"spline", "false"}}).kind,
            ErrorKind::input);
  EXPECT_EQ(refusal("synthesize-polygon", {}, {{"points", square}, {"spline", "false"}, {"samples", "20"}}).kind,
            ErrorKind::usage);
  EXPECT_EQ(refusal("synthesize-polygon", {}, {}).kind, ErrorKind::usage);
}

TEST(SynthesizeOperations, TakeNoInputs) {
  EXPECT_EQ(refusal("synthesize-circle", {slope()}, {{"center", "0,0"}, {"radius", "1"}}).code, "unknown-input");
}

}  // namespace
}  // namespace terrane
