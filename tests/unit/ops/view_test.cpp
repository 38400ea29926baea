// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "unit/ops/requests.hpp"

// rasterize, render, profile and sample through the door that all of them share.
using namespace terrane;

namespace {

const std::string utm = "EPSG:25831";
const std::string ramp = square(470000, 4380000, 100, 10, 0.1, utm);

struct Grid {
  Raster raster;
  Crs crs;
};

Grid grid_of(const Response& r, const char* word = "tif") {
  Context context;
  const Dataset data = format_named(word)->read(r.body, {.name = "result"}, context);
  return {std::get<Raster>(data.surface), data.crs};
}

std::string hills(int n, double cell, double x, double y, bool holes = true) {
  std::ostringstream grid;
  grid << "ncols " << n << "\nnrows " << n << "\nxllcorner " << x << "\nyllcorner " << y << "\ncellsize " << cell
       << "\nNODATA_value -9999\n";
  grid.precision(17);
  for (int j = 0; j < n; ++j, grid << "\n")
    for (int i = 0; i < n; ++i) {
      const double z = 300 + 200 * std::sin(i * 0.13) * std::cos(j * 0.17);
      if (holes && (i * 7 + j * 3) % 53 == 0)
        grid << "-9999 ";
      else
        grid << z << " ";
    }
  return grid.str();
}

std::vector<std::vector<std::string>> table(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back(1);
    for (const char c : line)
      if (c == ',')
        rows.back().emplace_back();
      else
        rows.back().back() += c;
  }
  return rows;
}

}  // namespace

TEST(Rasterize, CellsLieAtMultiplesOfTheirSize) {
  const Response r = run({"rasterize", {part("surface", square(3, 4, 95, 10, 0, utm))}, {{"cell-size", "10"}}});
  EXPECT_EQ(r.media_type, "image/tiff");
  const Grid g = grid_of(r);
  EXPECT_EQ(g.raster.x0, 5);
  EXPECT_EQ(g.raster.y0, 95);
  EXPECT_EQ(g.raster.width, 10);
  EXPECT_EQ(g.raster.height, 10);
  EXPECT_EQ(g.crs.id(), utm);
  for (const double z : g.raster.samples) EXPECT_EQ(z, 10);
}

TEST(Rasterize, HeightsAreThoseOfTheCentres) {
  const Grid g = grid_of(run({"rasterize", {part("surface", ramp)}, {{"cell-size", "20"}}}));
  ASSERT_EQ(g.raster.width, 5);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(g.raster.at(i, 2), 10 + 0.1 * (10 + 20 * i), 1e-10);
}

TEST(Rasterize, BboxIsTheEdgeAndOutsideIsNoData) {
  const Grid g = grid_of(
      run({"rasterize", {part("surface", ramp)}, {{"cell-size", "7"}, {"bbox", "469995,4379990,470020,4380011"}}}));
  EXPECT_EQ(g.raster.width, 4);  // 25 over 7
  EXPECT_EQ(g.raster.height, 3);
  EXPECT_EQ(g.raster.x0, 469998.5);
  EXPECT_EQ(g.raster.y0, 4380007.5);
  EXPECT_TRUE(std::isnan(g.raster.at(0, 0)));
  EXPECT_FALSE(std::isnan(g.raster.at(1, 0)));
  EXPECT_TRUE(std::isnan(g.raster.at(1, 2)));
}

TEST(Rasterize, WidthAndHeightDivideTheSurface) {
  const Grid g = grid_of(run({"rasterize", {part("surface", ramp)}, {{"width", "4"}, {"height", "2"}}}));
  EXPECT_EQ(g.raster.dx, 25);
  EXPECT_EQ(g.raster.dy, 50);
  EXPECT_EQ(g.raster.width, 4);
  EXPECT_EQ(g.raster.height, 2);
  const Grid one = grid_of(run({"rasterize", {part("surface", ramp)}, {{"width", "8"}}}));
  EXPECT_EQ(one.raster.dy, 12.5);
  EXPECT_EQ(one.raster.height, 8);
}

TEST(Rasterize, LikeGivesBackTheRasterItself) {
  const std::string dem = hills(40, 30, 470000, 4380000);
  const std::vector<std::pair<std::string, std::string>> crs = {{"assume-crs", utm}};
  const Response r = run({"rasterize", {{"surface", "a.asc", "", dem}, {"like", "b.asc", "", dem}}, crs});
  const Grid g = grid_of(r);
  Context context;
  const Raster before = std::get<Raster>(format_named("asc")->read(dem, {}, context).surface);
  ASSERT_EQ(g.raster.samples.size(), before.samples.size());
  std::size_t lone = 0;
  for (std::size_t k = 0; k < before.samples.size(); ++k) {
    if (std::isnan(before.samples[k])) continue;
    if (std::isnan(g.raster.samples[k])) {
      ++lone;  // no triangle has it
    } else {
      ASSERT_EQ(g.raster.samples[k], before.samples[k]) << k;
    }
  }
  EXPECT_LE(lone, 2u);
  EXPECT_EQ(g.raster.x0, before.x0);
  EXPECT_EQ(g.raster.y0, before.y0);
}

TEST(Rasterize, LikeSettlesTheCrs) {
  const std::string degrees = "ncols 50\nnrows 50\nxllcorner 2.65\nyllcorner 39.56\ncellsize 0.0001\n" + [] {
    std::string rows;
    for (int k = 0; k < 2500; ++k) rows += "0 ";
    return rows;
  }();
  const Response r = run({"rasterize",
                          {part("surface", square(470000, 4379000, 1000, 5, 0, utm)), {"like", "g.asc", "", degrees}},
                          {{"assume-crs", "like:EPSG:4326"}}});
  const Grid g = grid_of(r);
  EXPECT_TRUE(g.crs.geographic());
  EXPECT_EQ(g.raster.width, 50);
  for (const double z : g.raster.samples)
    if (!std::isnan(z)) {
      EXPECT_NEAR(z, 5, 1e-9);
    }
  EXPECT_EQ(refusal({"rasterize",
                     {part("surface", ramp), {"like", "g.asc", "", degrees}},
                     {{"assume-crs", "like:EPSG:4326"}, {"target-crs", utm}}})
                .code,
            "bad-parameter");
}

TEST(Rasterize, TheUpperFaceAtWalls) {
  const std::string walls =
      R"({"type":"TIN","crs":"local:m","vertices":[[0,0,1],[1,0,1],[1,2,1],[0,2,1],[1,0,5],[2,0,5],[2,2,5],[1,2,5]],)"
      R"("triangles":[[0,1,2],[0,2,3],[4,5,6],[4,6,7],[1,4,7],[1,7,2]]})";
  const Grid g = grid_of(run({"rasterize", {part("surface", walls)}, {{"cell-size", "2"}, {"bbox", "0,0,2,2"}}}));
  ASSERT_EQ(g.raster.samples.size(), 1u);
  EXPECT_EQ(g.raster.samples[0], 5);
}

TEST(Rasterize, DegreesAndLengths) {
  const std::string tile = square(2, 39, 0.1, 5, 0, "EPSG:4326");
  const Grid g = grid_of(run({"rasterize", {part("surface", tile)}, {{"cell-size", "0.01deg"}}}));
  EXPECT_EQ(g.raster.dx, 0.01);
  EXPECT_EQ(g.raster.width, 10);
  const Grid metres = grid_of(run({"rasterize", {part("surface", tile)}, {{"cell-size", "1500m"}}}));
  EXPECT_EQ(metres.raster.dx, 0.01);  // 1.1 km
  EXPECT_EQ(refusal({"rasterize", {part("surface", ramp)}, {{"cell-size", "1deg"}}}).kind, ErrorKind::usage);
  const Grid feet = grid_of(run({"rasterize", {part("surface", ramp)}, {{"cell-size", "32.8084ft"}}}));
  EXPECT_NEAR(feet.raster.dx, 10, 1e-5);
}

TEST(Rasterize, ChoosesCellsWhereNoneAreGiven) {
  const Response r =
      run({"rasterize", {{"surface", "a.asc", "", hills(40, 30, 470000, 4380000)}}, {{"assume-crs", utm}}});
  EXPECT_TRUE(warned(r, "cell-size-chosen"));
  EXPECT_EQ(grid_of(r).raster.dx, 20);
}

TEST(Rasterize, RefusesWhatCannotBeMade) {
  const auto of = [](std::vector<std::pair<std::string, std::string>> p) {
    return refusal({"rasterize", {part("surface", ramp)}, std::move(p)});
  };
  const Error many = of({{"cell-size", "0.001"}});
  EXPECT_EQ(many.kind, ErrorKind::limit);
  EXPECT_NE(std::string(many.what()).find("100000 x 100000"), std::string::npos) << many.what();
  EXPECT_EQ(of({{"cell-size", "1e-300"}}).kind, ErrorKind::limit);
  EXPECT_EQ(of({{"cell-size", "0"}}).kind, ErrorKind::usage);
  EXPECT_EQ(of({{"cell-size", "1e300"}}).kind, ErrorKind::usage);
  EXPECT_EQ(of({{"bbox", "-1e300,0,1e300,1"}, {"width", "1"}, {"height", "1"}}).kind, ErrorKind::usage);
  EXPECT_EQ(of({{"cell-size", "-5"}}).kind, ErrorKind::usage);
  EXPECT_EQ(of({{"cell-size", "wide"}}).kind, ErrorKind::usage);
  EXPECT_EQ(of({{"cell-size", "5"}, {"width", "3"}}).kind, ErrorKind::usage);
  EXPECT_EQ(of({{"bbox", "1,2,3"}}).kind, ErrorKind::usage);
  EXPECT_EQ(of({{"bbox", "3,2,1,4"}}).kind, ErrorKind::usage);
  EXPECT_EQ(of({{"cell-size", "1e-9"}, {"bbox", "470000,4380000,470000.0000001,4380000.0000001"}}).kind,
            ErrorKind::usage);
  EXPECT_EQ(refusal({"rasterize", {part("surface", ramp), part("like", ramp)}}).code, "not-a-raster");
  EXPECT_EQ(refusal({"rasterize",
                     {part("surface", ramp), {"like", "g.asc", "", hills(4, 1, 0, 0)}},
                     {{"assume-crs", utm}, {"cell-size", "1"}}})
                .kind,
            ErrorKind::usage);
}

TEST(Rasterize, AsAsciiGridAndEmptyWithAWarning) {
  const Response r = run({"rasterize", {part("surface", ramp)}, {{"cell-size", "50"}}, "asc"});
  EXPECT_NE(r.body.find("ncols 2\nnrows 2\n"), std::string::npos) << r.body;
  EXPECT_NE(r.body.find("NODATA_value -9999\n"), std::string::npos);
  EXPECT_EQ(r.report["raster"]["width"], 2);
  EXPECT_TRUE(
      warned(run({"rasterize", {part("surface", ramp)}, {{"cell-size", "5"}, {"bbox", "0,0,10,10"}}}), "no-overlap"));
}

TEST(Profile, EveryEdgeIsARow) {
  const Response r = run({"profile", {part("surface", ramp)}, {{"line", "470000,4380050,470100,4380050"}}});
  EXPECT_EQ(r.media_type, "text/csv");
  const auto rows = table(r.body);
  ASSERT_EQ(rows.size(), 4u) << r.body;
  EXPECT_EQ(rows[0], (std::vector<std::string>{"distance", "x", "y", "z"}));
  EXPECT_EQ(rows[2], (std::vector<std::string>{"50", "470050", "4380050", "15"}));
  EXPECT_EQ(rows[3][0], "100");
}

TEST(Profile, SeveralSurfacesShareTheRows) {
  const std::string other = square(470050, 4380000, 100, 3, 0, utm);
  const Response r = run({"profile",
                          {part("surface", ramp, "old.json"), part("surface", other, "new.json")},
                          {{"line", "LINESTRING (470000 4380020, 470150 4380020)"}}});
  const auto rows = table(r.body);
  EXPECT_EQ(rows[0], (std::vector<std::string>{"distance", "x", "y", "z_old", "z_new"}));
  EXPECT_EQ(rows[1][4], "");
  EXPECT_EQ(rows.back()[3], "");
  EXPECT_EQ(rows.back()[4], "3");
  for (const auto& row : rows) EXPECT_EQ(row.size(), 5u);
}

TEST(Profile, AsLinesInSpace) {
  const Response r = run({"profile", {part("surface", ramp)}, {{"line", "469900,4380050,470200,4380050"}}, "geojson"});
  EXPECT_EQ(r.media_type, "application/geo+json");
  const auto json = nlohmann::json::parse(r.body);
  ASSERT_EQ(json["features"].size(), 1u);
  const auto& feature = json["features"][0];
  EXPECT_EQ(feature["geometry"]["type"], "LineString");
  EXPECT_EQ(feature["geometry"]["coordinates"][0], nlohmann::json({470000, 4380050, 10}));
  EXPECT_EQ(feature["properties"]["from"], 100);
  EXPECT_EQ(feature["properties"]["to"], 200);
}

TEST(Profile, AsAChart) {
  const Response r = run({"profile", {part("surface", ramp)}, {{"line", "469900,4380050,470200,4380050"}}, "png"});
  EXPECT_EQ(r.media_type, "image/png");
  EXPECT_TRUE(r.body.starts_with("\x89PNG"));
}

TEST(Profile, DistancesAreOnTheGroundInDegrees) {
  const std::string tile = square(2, 39, 1, 5, 0, "EPSG:4326");
  const auto rows = table(run({"profile", {part("surface", tile)}, {{"line", "2,39,3,39"}}}).body);
  EXPECT_NEAR(std::stod(rows.back()[0]), 86626.404, 0.001);  // a degree along the parallel of 39 degrees north
}

TEST(Profile, LinesInAnotherCrsAndGeoJsonDegrees) {
  const std::string line = R"({"type":"LineString","coordinates":[[2.652,39.568],[2.651,39.5685]]})";
  const auto rows =
      table(run({"profile", {part("surface", square(469000, 4379000, 3000, 5, 0, utm))}, {{"line", line}}}).body);
  EXPECT_GT(std::stod(rows[1][1]), 469000);
  EXPECT_EQ(rows[1][3], "5");
}

TEST(Profile, SeveralLinesAreNumbered) {
  const auto rows =
      table(run({"profile",
                 {part("surface", ramp)},
                 {{"line", "MULTILINESTRING ((470000 4380010, 470100 4380010), (470010 4380000, 470010 4380100))"}}})
                .body);
  EXPECT_EQ(rows[0][0], "line");
  EXPECT_EQ(rows.back()[0], "2");
}

TEST(Profile, RefusesWhatIsNoLine) {
  EXPECT_EQ(refusal({"profile", {part("surface", ramp)}}).kind, ErrorKind::usage);
  EXPECT_EQ(refusal({"profile", {part("surface", ramp)}, {{"line", "470000,4380050"}}}).code, "no-line");
  EXPECT_EQ(refusal({"profile", {part("surface", ramp)}, {{"line", "470000,4380050,470000,4380050"}}}).code, "no-line");
  EXPECT_EQ(refusal({"profile", {part("surface", ramp)}, {{"line", "0,0,1e300,1"}}}).code, "overflow");
  EXPECT_TRUE(warned(run({"profile", {part("surface", ramp)}, {{"line", "0,0,1,1"}}}), "no-overlap"));
  EXPECT_TRUE(warned(run({"profile", {part("surface", ramp)}, {{"line", "-1e99,0,1e99,1"}}}), "no-overlap"));
}

TEST(Sample, HeightsAtPointsAndNothingOutside) {
  const Response r = run({"sample", {part("surface", ramp)}, {{"points", "470000,4380000;470050,4380020;0,0"}}});
  const auto rows = table(r.body);
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0], (std::vector<std::string>{"x", "y", "z"}));
  EXPECT_EQ(rows[1][2], "10");
  EXPECT_EQ(rows[2][2], "15");
  EXPECT_EQ(rows[3][2], "");
}

TEST(Sample, PointsAreLaidOverTheSurfaceEachByItself) {
  const std::string across = square(179, 10, 2, 0, 10, "EPSG:4326");
  for (const char* points : {"-179.5,11;179.5,11;180.5,11", "LINESTRING(-179.5 11,179.5 11,180.5 11)"}) {
    const Response r = run({"sample", {part("surface", across)}, {{"points", points}}});
    const auto rows = table(r.body);
    ASSERT_EQ(rows.size(), 4u);
    EXPECT_EQ(rows[1], (std::vector<std::string>{"180.5", "11", "15"}));
    EXPECT_EQ(rows[2], (std::vector<std::string>{"179.5", "11", "5"}));
    EXPECT_EQ(rows[3], (std::vector<std::string>{"180.5", "11", "15"}));
    EXPECT_FALSE(warned(r, "long-way-round"));
  }
}

TEST(Sample, PropertiesStayAndHeightsThatCameAreKept) {
  const std::string points =
      R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:25831"}},"features":[)"
      R"({"type":"Feature","properties":{"id":"A, 1","z":3},"geometry":{"type":"Point","coordinates":[470020,4380020,11.5]}},)"
      R"({"type":"Feature","properties":{"id":"B"},"geometry":{"type":"MultiPoint","coordinates":[[470030,4380020],[1,1]]}}]})";
  const Response r = run({"sample", {part("surface", ramp)}, {{"points", points}}});
  std::istringstream lines(r.body);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "id,z_,x,y,given_z,z");
  std::getline(lines, line);
  EXPECT_EQ(line, "\"A, 1\",3,470020,4380020,11.5,12");
  std::getline(lines, line);
  EXPECT_EQ(line, "B,,470030,4380020,,13");
  std::getline(lines, line);
  EXPECT_EQ(line, "B,,1,1,,");
  const auto json =
      nlohmann::json::parse(run({"sample", {part("surface", ramp)}, {{"points", points}}, "geojson"}).body);
  ASSERT_EQ(json["features"].size(), 3u);
  EXPECT_EQ(json["features"][0]["geometry"]["coordinates"][2], 12);
  EXPECT_EQ(json["features"][1]["properties"]["z"], 13);
  EXPECT_TRUE(json["features"][2]["properties"]["z"].is_null());
}

TEST(Sample, TheUpperHeightAtAWall) {
  const std::string walls =
      R"({"type":"TIN","crs":"local:m","vertices":[[0,0,1],[1,0,1],[1,2,1],[0,2,1],[1,0,5],[2,0,5],[2,2,5],[1,2,5]],)"
      R"("triangles":[[0,1,2],[0,2,3],[4,5,6],[4,6,7],[1,4,7],[1,7,2]]})";
  EXPECT_EQ(table(run({"sample", {part("surface", walls)}, {{"points", "1,1"}}}).body)[1][2], "5");
}

TEST(Sample, AgreesWithRasterizeAndWithAnyNumberOfThreads) {
  const std::string dem = hills(60, 10, 470000, 4380000);
  const Grid g =
      grid_of(run({"rasterize", {{"surface", "a.asc", "", dem}}, {{"assume-crs", utm}, {"cell-size", "7"}}}));
  std::string points;
  for (int j = 0; j < g.raster.height; ++j)
    for (int i = 0; i < g.raster.width; ++i) {
      const Point2 p = g.raster.place(i, j);
      points += nlohmann::json(p.x).dump() + "," + nlohmann::json(p.y).dump() + "\n";
    }
  const Request c{"sample", {{"surface", "a.asc", "", dem}}, {{"assume-crs", utm}, {"points", points}}};
  const Response r = run(c);
  EXPECT_EQ(r.body, run(c, 3).body);
  const auto rows = table(r.body);
  ASSERT_EQ(rows.size(), g.raster.samples.size() + 1);
  for (std::size_t k = 0; k < g.raster.samples.size(); ++k) {
    ASSERT_EQ(rows[k + 1][2].empty(), std::isnan(g.raster.samples[k])) << k;
    if (!rows[k + 1][2].empty()) {
      ASSERT_NEAR(std::stod(rows[k + 1][2]), g.raster.samples[k], 1e-9);
    }
  }
}

TEST(Sample, TheProfileOfALineIsOnTheSurface) {
  const std::string dem = hills(50, 10, 470000, 4380000);
  const auto profile =
      table(run({"profile",
                 {{"surface", "a.asc", "", dem}},
                 {{"assume-crs", utm}, {"line", "470012.3,4380033.3,470433.1,4380222.7,470100,4380470"}}})
                .body);
  std::string points;
  for (std::size_t k = 1; k < profile.size(); ++k) points += profile[k][1] + "," + profile[k][2] + "\n";
  const auto sampled =
      table(run({"sample", {{"surface", "a.asc", "", dem}}, {{"assume-crs", utm}, {"points", points}}}).body);
  std::size_t compared = 0;
  for (std::size_t k = 1; k < profile.size(); ++k) {
    if (profile[k][3].empty() || sampled[k][2].empty()) continue;
    ASSERT_NEAR(std::stod(profile[k][3]), std::stod(sampled[k][2]), 1e-7) << k;
    ++compared;
  }
  EXPECT_GT(compared, 150u);
}

TEST(Sample, RefusesNoPoints) {
  EXPECT_EQ(refusal({"sample", {part("surface", ramp)}}).kind, ErrorKind::usage);
  EXPECT_EQ(refusal({"sample", {part("surface", ramp)}, {{"points", "POINT EMPTY"}}}).kind, ErrorKind::input);
  EXPECT_EQ(refusal({"sample", {part("surface", ramp)}, {{"points", "north"}}}).kind, ErrorKind::usage);
}

TEST(Render, EveryShadingAndWires) {
  for (const char* shading : {"hillshade", "elevation", "diverging"})
    for (const char* wires : {"false", "true"}) {
      const Response r = run({"render",
                              {part("surface", square(470000, 4380000, 100, -5, 0.1, utm))},
                              {{"shading", shading}, {"wireframe", wires}, {"size", "300"}}});
      EXPECT_EQ(r.media_type, "image/png");
      EXPECT_TRUE(r.body.starts_with("\x89PNG"));
    }
}

TEST(Render, FlatAndZeroSurfacesHavePicturesToo) {
  for (const double z : {0.0, 7.0, -3.0})
    for (const char* shading : {"elevation", "diverging"})
      EXPECT_TRUE(run({"render", {part("surface", square(0, 0, 100, z, 0, "local:m"))}, {{"shading", shading}}})
                      .body.starts_with("\x89PNG"));
}
