// SPDX-License-Identifier: GPL-3.0-or-later
// volume within regions, and as polygons, through the request path.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "io/vectors.hpp"
#include "ops/volume_regions.hpp"
#include "unit/ops/requests.hpp"

using namespace terrane;

namespace {

/// n x n cells of 10 m from (500000, 4600000), heights by a function of the cell's corner.
template <class Height>
std::string grid(int n, Height height, const std::string& crs = "EPSG:25831") {
  return lattice(n, 500000, 4600000, 10, height, crs);
}

std::string hills(int n) {
  return grid(n, [](int i, int j) { return 20 + 6 * std::sin(0.9 * i) + 5 * std::cos(0.7 * j + 0.2 * i); });
}
std::string plain(int n) {
  return grid(n, [](int i, int j) { return 20 + 0.1 * i - 0.07 * j; });
}

Response run(const std::string& surface, const std::string& reference, Parameters parameters,
             const std::string& format = "") {
  Request request;
  request.operation = "volume";
  request.inputs.push_back({"surface", surface[0] == '{' ? "s.json" : "s.asc", "", surface});
  if (!reference.empty()) {
    const bool tin = reference[0] == '{';
    request.inputs.push_back({"reference", tin ? "r.json" : "", "", reference});
  }
  request.parameters = std::move(parameters);
  request.format = format;
  return terrane::run(std::move(request), 2);
}

Error refusal(const std::string& surface, const std::string& reference, Parameters parameters,
              const std::string& format = "") {
  return refusal_of([&] { run(surface, reference, std::move(parameters), format); });
}

const Warning* warning(const Response& r, std::string_view code) {
  const auto it = std::find_if(r.warnings.begin(), r.warnings.end(), [&](const Warning& w) { return w.code == code; });
  return it == r.warnings.end() ? nullptr : &*it;
}

nlohmann::json box(double x0, double y0, double x1, double y1, nlohmann::json properties) {
  const double x = 500000, y = 4600000;
  return {{"type", "Feature"},
          {"properties", std::move(properties)},
          {"geometry",
           {{"type", "Polygon"},
            {"coordinates",
             {{{x + x0, y + y0}, {x + x1, y + y0}, {x + x1, y + y1}, {x + x0, y + y1}, {x + x0, y + y0}}}}}}};
}

std::string collection(std::vector<nlohmann::json> features) {
  return nlohmann::json{{"type", "FeatureCollection"},
                        {"crs", {{"type", "name"}, {"properties", {{"name", "urn:ogc:def:crs:EPSG::25831"}}}}},
                        {"features", std::move(features)}}
      .dump();
}

/// n x n crooked quadrilaterals that tile a box a little larger than the surface.
std::string parcels(int n, double extent) {
  std::vector<nlohmann::json> features;
  const auto corner = [&](int i, int j) -> nlohmann::json {
    const double step = (extent + 6) / n;
    const bool border = i == 0 || j == 0 || i == n || j == n;
    return {500000 - 3 + step * i + (border ? 0 : 0.3 * step * std::sin(5.1 * i + 2.3 * j)),
            4600000 - 3 + step * j + (border ? 0 : 0.3 * step * std::cos(3.7 * i - 1.9 * j))};
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      features.push_back(
          {{"type", "Feature"},
           {"properties", {{"name", "p" + std::to_string(j * n + i)}}},
           {"geometry",
            {{"type", "Polygon"},
             {"coordinates",
              {{corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1), corner(i, j)}}}}}});
  return collection(features);
}

double sum(const nlohmann::json& rows, const std::string& pointer) {
  double total = 0;
  for (const auto& row : rows) total += row.at(nlohmann::json::json_pointer(pointer)).get<double>();
  return total;
}

const char* const additive[] = {"/net_volume", "/same/area_2d", "/coverage/overlap_area_2d",
                                "/coverage/surface_only_area_2d", "/coverage/reference_only_area_2d"};

void expect_tiles_the_whole(const nlohmann::json& parts, const nlohmann::json& whole, const std::string& up,
                            const std::string& down) {
  std::vector<std::string> pointers(std::begin(additive), std::end(additive));
  for (const std::string& side : {up, down})
    for (const char* figure : {"volume", "area_2d", "area_3d"}) pointers.push_back("/" + side + "/" + figure);
  for (const char* key : {"cut", "fill", "net"}) {
    const std::string side = std::string(key) == "cut" ? down : std::string(key) == "fill" ? up : key;
    pointers.push_back("/ellipsoidal/" + side + "_volume");
  }
  for (const std::string& pointer : pointers)
    EXPECT_NEAR(sum(parts, pointer), sum(whole, pointer), 1e-9 * (1 + std::fabs(sum(whole, pointer)))) << pointer;
}

}  // namespace

TEST(VolumeRegions, RowsAreNamedAndMeasuredWithinTheirPolygons) {
  const std::string regions = collection({box(0, 0, 50, 50, {{"name", "north, \"A\""}, {"fid", 9}}),
                                          box(50, 0, 100, 50, {{"id", 17}}), box(0, 50, 20, 100, {{"owner", "x"}})});
  const std::string flat = grid(10, [](int, int) { return 12; });
  const Response r = run(flat, "10", {{"region", regions}});
  const auto& rows = r.report["rows"];
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0]["region"], "north, \"A\"");
  EXPECT_EQ(rows[1]["region"], 17);
  EXPECT_EQ(rows[2]["region"], 3) << "the number of the feature, from 1";
  EXPECT_NEAR(rows[0]["above"]["volume"].get<double>(), 5000, 1e-6);
  EXPECT_NEAR(rows[2]["above"]["volume"].get<double>(), 2000, 1e-6);
  EXPECT_EQ(rows[0]["level"], 10);
  const Response csv = run(flat, "10", {{"region", regions}}, "csv");
  EXPECT_NE(csv.body.find("\n\"north, \"\"A\"\"\",10.0,"), std::string::npos) << csv.body;
  EXPECT_NE(csv.body.find("\n17,10.0,"), std::string::npos) << csv.body;
}

TEST(VolumeRegions, WhatSeveralHaveInCommonIsCutOutOnce) {
  const Polygon here = {{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}}, {}}, there = {{{5, 5, 0}, {9, 5, 0}, {9, 9, 0}}, {}};
  std::vector<VolumeRegion> regions;
  for (int i = 0; i < 500; ++i) regions.push_back({i, {i == 7 ? there : here}});
  Surface surface;
  surface.value = Tin{{{0, 0, 1}, {9, 0, 1}, {9, 9, 1}, {0, 9, 1}}, {{0, 1, 2}, {0, 2, 3}}};
  std::vector<std::vector<std::size_t>> seen;
  Context context;
  for_each_part(surface, nullptr, regions, context,
                [&](const auto& alike, const VolumePart&, Context&) { seen.push_back(alike); });
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].size(), 499u);
  EXPECT_EQ(seen[1], std::vector<std::size_t>{7});
}

TEST(VolumeRegions, AlikeOnesHaveARowAndAPlaceInWarningsEach) {
  const Response r =
      run(hills(10), "20",
          {{"region", collection({box(10, 10, 50, 40, {{"name", "a"}}), box(900, 0, 950, 9, {{"name", "b"}}),
                                  box(10, 10, 50, 40, {{"name", "c"}}), box(900, 0, 950, 9, {{"name", "d"}})})}});
  auto rows = r.report["rows"];
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[2]["region"], "c");
  rows[2]["region"] = "a";
  EXPECT_EQ(rows[2], rows[0]);
  ASSERT_NE(warning(r, "region-outside"), nullptr);
  EXPECT_NE(warning(r, "region-outside")->message.find("'b', 'd'"), std::string::npos);
}

TEST(VolumeRegions, PartsThatTileTheSurfaceAddUpToIt) {
  const std::string surface = hills(20), reference = plain(17);
  for (const char* tolerance : {"0", "0.5"}) {
    const Parameters whole = {{"tolerance", tolerance}};
    Parameters parts = whole;
    parts.emplace_back("region", parcels(6, 200));
    const Response split = run(surface, reference, parts);
    EXPECT_EQ(split.report["rows"].size(), 36u);
    expect_tiles_the_whole(split.report["rows"], run(surface, reference, whole).report["rows"], "fill", "cut");
    Parameters level_parts = parts;
    expect_tiles_the_whole(run(surface, "21", parts).report["rows"], run(surface, "21", whole).report["rows"], "above",
                           "below");
  }
}

TEST(VolumeRegions, LevelsGiveARowForEachRegionAndLevel) {
  const auto rows = run(hills(10), "", {{"region", parcels(2, 100)}, {"levels", "15:25:5"}}).report["rows"];
  ASSERT_EQ(rows.size(), 12u);
  EXPECT_EQ(rows[0]["region"], "p0");
  EXPECT_EQ(rows[2]["level"], 25);
  EXPECT_EQ(rows[3]["region"], "p1");
  EXPECT_EQ(rows[3]["level"], 15);
}

TEST(VolumeRegions, BoundaryIsTheToeOfEachPart) {
  // A pyramid of 4 cells on level ground; drawn round, it stands on the ground, whatever lies elsewhere.
  const std::string surface = grid(20, [](int i, int j) {
    return i < 10 ? 100 + std::max(0, 4 - std::max(std::abs(i - 5), std::abs(j - 5))) : 3.0 * i;
  });
  const auto row =
      run(surface, "boundary", {{"region", collection({box(5, 5, 90, 95, {{"name", "pile"}})})}}).report["rows"][0];
  // Heights 0..4 on squares of 80, 60, 40, 20 m, grid diagonals: compare with the volume above the ground it stands on.
  const auto above = run(surface, "100", {{"region", collection({box(5, 5, 90, 95, {})})}}).report["rows"][0];
  EXPECT_NEAR(row["fill"]["volume"].get<double>(), above["above"]["volume"].get<double>(), 40);
  EXPECT_GT(row["fill"]["volume"].get<double>(), 5000);
  EXPECT_EQ(row["coverage"]["surface_only_area_2d"], 0.0);
}

TEST(VolumeRegions, WhatLiesElsewhereOrHasNoAreaIsARowOfZeros) {
  const std::string regions =
      collection({box(0, 0, 50, 50, {{"name", "here"}}), box(5000, 0, 5050, 50, {{"name", "far"}}),
                  box(10, 10, 40, 10, {{"name", "thin"}})});
  for (const std::string& reference : {std::string("5"), plain(10), std::string("boundary")}) {
    const Response r = run(hills(10), reference, {{"region", regions}});
    ASSERT_EQ(r.report["rows"].size(), 3u);
    EXPECT_GT(r.report["rows"][0]["coverage"]["overlap_area_2d"].get<double>(), 2400);
    for (int i : {1, 2}) {
      EXPECT_EQ(r.report["rows"][i]["net_volume"], 0.0);
      EXPECT_EQ(r.report["rows"][i]["coverage"]["overlap_area_2d"], 0.0);
    }
    ASSERT_TRUE(warning(r, "region-outside"));
    EXPECT_EQ(warning(r, "region-outside")->element, "region 'far'");
    ASSERT_TRUE(warning(r, "empty-region"));
    EXPECT_EQ(warning(r, "empty-region")->element, "region 'thin'");
  }
  EXPECT_EQ(refusal(hills(5), "5", {{"region", "POINT(500010 4600010)"}}).code, "no-polygons");
  EXPECT_EQ(refusal(hills(5), "5", {{"region", "nonsense"}}).kind, ErrorKind::usage);
}

TEST(VolumeRegions, RegionsMayOverlapAndBeWrittenOut) {
  const std::string flat = grid(10, [](int, int) { return 1; });
  const auto overlapping = run(flat, "0", {{"region", collection({box(0, 0, 60, 60, {}), box(30, 30, 90, 90, {})})}});
  EXPECT_NEAR(sum(overlapping.report["rows"], "/above/volume"), 7200, 1e-6);
  const auto corners = run(flat, "0", {{"region", "500010,4600010;500030,4600010;500030,4600030"}});
  EXPECT_NEAR(sum(corners.report["rows"], "/above/volume"), 200, 1e-6);
  EXPECT_EQ(corners.report["rows"][0]["region"], 1);
}

TEST(VolumePolygons, AddUpToTheReportAndSayWhereTheyAre) {
  const std::string surface = hills(20), reference = plain(17);
  for (const Parameters& more :
       {Parameters{}, Parameters{{"tolerance", "0.7"}}, Parameters{{"region", parcels(3, 200)}}}) {
    Parameters polygons = more;
    polygons.emplace_back("polygons", "true");
    const Response r = run(surface, reference, polygons);
    EXPECT_EQ(r.media_type, "application/geo+json");
    const auto features = nlohmann::json::parse(r.body)["features"];
    const auto report = run(surface, reference, more).report;
    EXPECT_EQ(r.report["volume"]["rows"], report["rows"]);
    double volume[2] = {0, 0}, area[3] = {0, 0, 0}, slanted[2] = {0, 0};
    for (const auto& f : features) {
      const auto& p = f["properties"];
      const int kind = p["kind"] == "above" ? 0 : p["kind"] == "below" ? 1 : 2;
      area[kind] += p["area_2d"].get<double>();
      if (kind < 2) volume[kind] += p["volume"].get<double>(), slanted[kind] += p["area_3d"].get<double>();
      EXPECT_EQ(p.contains("region"), more.size() == 1 && more[0].first == "region");
      EXPECT_TRUE(f["geometry"]["type"] == "Polygon");
    }
    for (int kind : {0, 1}) {
      const std::string side = kind == 0 ? "/fill" : "/cut";
      EXPECT_NEAR(volume[kind], sum(report["rows"], side + "/volume"), 1e-9 * volume[kind]);
      EXPECT_NEAR(area[kind], sum(report["rows"], side + "/area_2d"), 1e-9 * area[kind]);
      EXPECT_NEAR(slanted[kind], sum(report["rows"], side + "/area_3d"), 1e-9 * slanted[kind]);
    }
    EXPECT_NEAR(area[2], sum(report["rows"], "/same/area_2d"), 1e-6);
    EXPECT_NEAR(area[0] + area[1] + area[2], sum(report["rows"], "/coverage/overlap_area_2d"), 1e-5);
  }
}

TEST(VolumePolygons, InOtherFormatsAndUnits) {
  const std::string surface = hills(10);
  for (const char* format : {"gpkg", "dxf"}) {
    const Response r = run(surface, "20", {{"polygons", "true"}}, format);
    Context context;
    const Vectors read = read_vectors(r.body, "x", context);
    EXPECT_GT(read.polygons().size(), 3u) << format;
  }
  EXPECT_EQ(refusal(surface, "20", {}, "geojson").kind, ErrorKind::usage);
  EXPECT_EQ(refusal(surface, "20", {{"polygons", "true"}}, "csv").kind, ErrorKind::usage);

  // Heights in feet over metres: a CRS of its own kind, whose areas in space need geodesy.
  const Parameters feet = {{"crs", "EPSG:25831+6360"}, {"levels", "18,22"}};
  Parameters polygons = feet;
  polygons.emplace_back("polygons", "true");
  const Response r = run(surface, "", polygons);
  const auto rows = r.report["volume"]["rows"];
  const auto collection = nlohmann::json::parse(r.body);
  for (const char* figure : {"volume", "area_2d", "area_3d"}) {
    double total = 0;
    for (const auto& f : collection["features"])
      if (f["properties"]["kind"] == "above") total += f["properties"][figure].get<double>();
    const double expected = sum(rows, std::string("/above/") + figure);
    EXPECT_NEAR(total, expected, 1e-9 * expected) << figure;
  }
}

TEST(VolumeRegions, AThousandParcelsOfALargeSurface) {
  const int n = 361;  // 259,200 faces
  std::string raster = "ncols " + std::to_string(n) + "\nnrows " + std::to_string(n) +
                       "\nxllcenter 500000\nyllcenter 4600000\ncellsize 1\n";
  for (int j = 0; j < n; ++j, raster += "\n")
    for (int i = 0; i < n; ++i)
      raster += std::to_string(50 + 9 * std::sin(0.05 * i) * std::cos(0.04 * j) + 0.3 * std::sin(1.7 * i + j)) + " ";
  const Parameters crs = {{"assume-crs", "EPSG:25831"}};
  Parameters parts = crs;
  parts.emplace_back("region", parcels(32, n - 1));
  const Response r = run(raster, "50", parts);
  EXPECT_EQ(r.report["rows"].size(), 1024u);
  expect_tiles_the_whole(r.report["rows"], run(raster, "50", crs).report["rows"], "above", "below");
}
