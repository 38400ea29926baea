// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ops/sha256.hpp"
#include "unit/io/tiff.hpp"
#include "unit/ops/requests.hpp"

using namespace terrane;

namespace {

const std::string utm = "EPSG:25831";
const std::string a = square(470000, 4380000, 100, 10, 0, utm), b = square(470050, 4380000, 100, 4, 0, utm);

}  // namespace

TEST(Execute, ADifferenceIsExactAndCertified) {
  const Response r = run({"subtract", {part("minuend", a), part("subtrahend", b)}});
  const auto tin = nlohmann::json::parse(r.body);
  for (const auto& v : tin["vertices"]) EXPECT_EQ(v[2], 6.0);
  EXPECT_EQ(tin["crs"], utm);
  const auto& c = r.report;
  EXPECT_EQ(c["type"], "Certificate");
  EXPECT_EQ(c["operation"], "subtract");
  EXPECT_EQ(c["inputs"][0]["sha256"], sha256(a));
  EXPECT_EQ(c["inputs"][0]["name"], "minuend.json");
  EXPECT_DOUBLE_EQ(c["output"]["area_2d"].get<double>(), 5000);
  EXPECT_NEAR(c["area_balance"]["residual"].get<double>(), 0, 1e-9);
  EXPECT_EQ(c["topology"],
            nlohmann::json({{"inverted", 0}, {"degenerate", 0}, {"t_junctions", 0}, {"non_manifold_edges", 0}}));
  EXPECT_GT(c["accuracy"]["points_checked"].get<int>(), 0);
  EXPECT_EQ(c["accuracy"]["max_height_error"], 0.0);
}

TEST(Execute, ANumberIsASurface) {
  const Response r = run({"add", {part("a", a), {"b", "", "", "2.5"}}});
  const auto tin = nlohmann::json::parse(r.body);
  for (const auto& v : tin["vertices"]) EXPECT_EQ(v[2], 12.5);
}

TEST(Execute, TheVerificationOfHeightsSeesEveryPolicy) {
  for (const char* overlap : {"first", "last", "min", "max", "mean", "sum"}) {
    const Response r = run({"merge", {part("tiles", a, "a.json"), part("tiles", b, "b.json")}, {{"overlap", overlap}}});
    EXPECT_LE(r.report["accuracy"]["max_height_error"].get<double>(), 1e-12) << overlap;
    EXPECT_GT(r.report["accuracy"]["points_checked"].get<int>(), 5) << overlap;
    EXPECT_DOUBLE_EQ(r.report["area_balance"]["expected"].get<double>(), 15000) << overlap;
    EXPECT_NEAR(r.report["area_balance"]["residual"].get<double>(), 0, 1e-6) << overlap;
    const auto& pair = r.report["seams"]["pairs"].at(0);
    EXPECT_EQ(pair["a"], "a.json");
    EXPECT_DOUBLE_EQ(pair["overlap"]["dz_median"].get<double>(), -6);
  }
}

TEST(Execute, MeshBytesDoNotTellNamesNorOrder) {
  for (const char* format : {"json", "obj", "ply"}) {
    const auto one =
        run({"merge", {part("tiles", a, "x.json"), part("tiles", b, "y.json")}, {{"overlap", "mean"}}, format});
    const auto two =
        run({"merge", {part("tiles", b), part("tiles", a)}, {{"overlap", "mean"}, {"threads", "2"}}, format});
    EXPECT_EQ(one.body, two.body) << format;
    EXPECT_EQ(one.body.find("x.json"), std::string::npos) << format;
  }
}

TEST(Execute, VolumesBetweenAndAboveALevel) {
  const Response r = run({"volume", {part("surface", a), part("reference", b)}});
  const auto& row = r.report["rows"][0];
  EXPECT_DOUBLE_EQ(row["fill"]["volume"].get<double>(), 30000);
  EXPECT_DOUBLE_EQ(row["cut"]["volume"].get<double>(), 0);
  EXPECT_DOUBLE_EQ(row["net_volume"].get<double>(), 30000);
  EXPECT_DOUBLE_EQ(row["coverage"]["surface_only_area_2d"].get<double>(), 5000);
  // On the central meridian's side of this zone the grid is up to 0.08 % smaller than the ground.
  EXPECT_NEAR(row["ellipsoidal"]["net_volume"].get<double>(),
              30000 / std::pow(row["combined_scale_factor"].get<double>(), 2), 0.1);
  EXPECT_LT(row["combined_scale_factor"].get<double>(), 1);
  EXPECT_EQ(r.report["units"]["volume"], "m3");

  const Response level = run({"volume", {part("surface", a), {"reference", "", "", "12"}}});
  EXPECT_DOUBLE_EQ(level.report["rows"][0]["below"]["volume"].get<double>(), 20000);
  const Response levels = run({"volume", {part("surface", a)}, {{"levels", "8:12:2"}}, "csv"});
  EXPECT_EQ(std::count(levels.body.begin(), levels.body.end(), '\n'), 4);
  EXPECT_EQ(levels.media_type, "text/csv");
}

TEST(Execute, AreasInSpaceInDegreesAreThoseOnTheGround) {
  // z rises by 1000 m over 0.01 degrees of longitude at 40 N, about 854 m: a slope that steepens areas by 1.54.
  const std::string ramp = square(3.0, 40.0, 0.01, 0, 100000, "EPSG:4326");
  const Response r = run({"volume", {part("surface", ramp), {"reference", "", "", "-1"}}});
  const auto& above = r.report["rows"][0]["above"];
  const double ratio = above["area_3d"].get<double>() / above["area_2d"].get<double>();
  EXPECT_NEAR(ratio, std::sqrt(1 + std::pow(1000 / 853.9, 2)), 2e-3);
  EXPECT_NEAR(above["area_2d"].get<double>(), 853.9 * 1110.4, 500);
}

TEST(Execute, InfoAndValidateReportInsteadOfRefusing) {
  const std::string dirty =
      R"({"type":"TIN","vertices":[[0,0,1],[10,0,1],[0,10,1],[9,9,5],[1,1,5]],"triangles":[[0,1,2],[4,1,3]]})";
  EXPECT_EQ(run({"info", {part("surface", dirty)}}).report["type"], "SurfaceInfo");
  const Response report = run({"validate", {part("surface", dirty)}});
  EXPECT_FALSE(report.report["valid"].get<bool>());
  EXPECT_EQ(refusal({"transform", {part("surface", dirty)}, {{"z-scale", "2"}}}).kind, ErrorKind::input);
  const Response mended = run({"validate", {part("surface", dirty)}, {{"repair", "true"}}});
  EXPECT_TRUE(run({"validate", {part("surface", mended.body)}}).report["valid"].get<bool>());
  EXPECT_EQ(mended.report["repair"]["sheets_merged"], 2);
  // What no sheet takes up is counted too: vertex 5 and a face without area.
  const std::string more =
      R"({"type":"TIN","vertices":[[0,0,1],[10,0,1],[0,10,1],[9,9,5],[1,1,5],[7,7,7]],
          "triangles":[[0,1,2],[4,1,3],[0,1,1]]})";
  const Response counted = run({"validate", {part("surface", more)}, {{"repair", "true"}}});
  EXPECT_EQ(counted.report["repair"]["unused_vertices"], 1);
  EXPECT_EQ(counted.report["repair"]["zero_area_faces"], 1);
}

TEST(Execute, CrsRules) {
  const std::string plain = square(470000, 4380000, 100, 1, 0, "");
  const Error missing = refusal({"merge", {part("tiles", a), part("tiles", plain)}});
  EXPECT_EQ(missing.code, "missing-crs");
  EXPECT_NE(std::string(missing.what()).find("assume-crs"), std::string::npos);
  EXPECT_NO_THROW(run({"merge", {part("tiles", a), part("tiles", plain)}, {{"assume-crs", utm}}}));

  const std::string zone32 = square(470000, 4380000, 100, 1, 0, "EPSG:25832");
  const Error mixed = refusal({"merge", {part("tiles", a), part("tiles", zone32)}});
  EXPECT_EQ(mixed.code, "mixed-crs");
  EXPECT_NE(std::string(mixed.what()).find("target-crs="), std::string::npos);
  const Response moved = run({"merge", {part("tiles", a), part("tiles", zone32)}, {{"target-crs", utm}}});
  EXPECT_EQ(moved.report["output"]["crs"], utm);
  EXPECT_EQ(moved.report["reprojection"]["from"].size(), 1u);

  EXPECT_TRUE(warned(run({"convert", {part("surface", plain)}}), "no-crs"));
  EXPECT_EQ(refusal({"merge", {part("tiles", square(470000, 4380000, 9, 1, 0, "EPSG:4326"))}}).code, "not-degrees");
  EXPECT_EQ(refusal({"merge", {part("tiles", a), part("tiles", square(2, 40, 1, 1, 0, utm))}}).code,
            "degrees-as-metres");
}

TEST(Execute, VerticalDatums) {
  const auto with = [](const std::string& crs, double z) { return square(470000, 4380000, 100, z, 0, crs); };
  const Error different = refusal(
      {"subtract", {part("minuend", with("EPSG:25831+5773", 5)), part("subtrahend", with("EPSG:25831+5621", 4))}});
  EXPECT_EQ(different.code, "vertical-datum");
  const Response half =
      run({"subtract", {part("minuend", with("EPSG:25831+5773", 5)), part("subtrahend", with("EPSG:25831", 4))}});
  ASSERT_TRUE(warned(half, "vertical-datum-unknown"));
  const auto found = std::find_if(half.warnings.begin(), half.warnings.end(),
                                  [](const Warning& w) { return w.code == "vertical-datum-unknown"; });
  EXPECT_NE(found->message.find("median difference is -1"), std::string::npos) << found->message;
  EXPECT_TRUE(warned(run({"subtract", {part("minuend", a), part("subtrahend", b)}}), "vertical-datum-unknown"));
}

TEST(Execute, HeightsAreNeverSilentlyUnshifted) {
  const std::string known = square(470000, 4380000, 100, 5, 0, "EPSG:25831+5773");
  EXPECT_TRUE(warned(run({"transform", {part("surface", known)}, {{"target-crs", "EPSG:4326"}}}), "heights-unshifted"));
  EXPECT_TRUE(
      warned(run({"transform", {part("surface", a)}, {{"target-crs", "EPSG:25831+5773"}}}), "heights-unshifted"));
}

TEST(Execute, TilesOnBothCountsOfLongitudeLieBesideEachOther) {
  const std::string west = square(359, 40, 1, 1, 0, "EPSG:4326"), east = square(0, 40, 1, 1, 0, "EPSG:4326");
  const Response r = run({"merge", {part("tiles", west, "w.json"), part("tiles", east, "e.json")}});
  EXPECT_EQ(r.report["output"]["components"], 1);
  for (const auto body = nlohmann::json::parse(r.body); const auto& v : body["vertices"])
    EXPECT_LE(std::fabs(v[0].get<double>()), 1.0);
}

TEST(Execute, FeetBecomeMetresInLocalFrames) {
  const std::string feet = square(0, 0, 100, 10, 0, "local:ft"), metres = square(0, 0, 30.48, 1, 0, "local:m");
  const Response r =
      run({"subtract", {part("minuend", metres), part("subtrahend", feet)}, {{"target-crs", "local:m"}}});
  EXPECT_TRUE(warned(r, "heights-converted"));
  EXPECT_NEAR(r.report["output"]["area_2d"].get<double>(), 30.48 * 30.48, 1e-9);
  EXPECT_NEAR(nlohmann::json::parse(r.body)["vertices"][0][2].get<double>(), 1 - 3.048, 1e-12);
}

TEST(Execute, TheUnitARasterSaysHoldsUnderEveryCrs) {
  const TiffTag feet =
      text("<GDALMetadata><Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">ft</Item></GDALMetadata>");
  const std::string located = tiff(2, 2, {10, 10, 10, 10}, {{42112, feet}});
  const std::string nowhere = tiff(2, 2, {10, 10, 10, 10}, {{42112, feet}, {34735, shorts({})}});
  const auto height = [](const std::string& bytes, std::vector<std::pair<std::string, std::string>> parameters,
                         bool converted) {
    const Response r = run({"convert", {part("surface", bytes, "dem.tif")}, std::move(parameters)});
    EXPECT_EQ(warned(r, "heights-converted"), converted);
    return nlohmann::json::parse(r.body)["vertices"][0][2].get<double>();
  };
  EXPECT_DOUBLE_EQ(height(located, {}, true), 3.048);
  EXPECT_DOUBLE_EQ(height(located, {{"crs", "EPSG:2263"}}, true), 10 * 0.3048 * 3937 / 1200);
  EXPECT_DOUBLE_EQ(height(located, {{"crs", "local:ft"}}, false), 10);
  EXPECT_DOUBLE_EQ(height(nowhere, {}, true), 3.048);
  EXPECT_DOUBLE_EQ(height(nowhere, {{"assume-crs", "EPSG:25831"}}, true), 3.048);
  EXPECT_DOUBLE_EQ(height(nowhere, {{"assume-crs", "local:ft"}}, false), 10);
  const Response info = run({"info", {part("surface", nowhere, "dem.tif")}});
  EXPECT_EQ(nlohmann::json::parse(info.body)["raster"]["height_range"][0], 10 * 0.3048);
}

TEST(Execute, SkirtsAreNoHeightsOfTheSurface) {
  nlohmann::json skirted = nlohmann::json::parse(square(0, 0, 10, 5, 0, ""));
  skirted["vertices"].push_back({0, 0, -3});
  skirted["vertices"].push_back({10, 0, -3});
  skirted["triangles"].push_back({1, 0, 4});
  skirted["triangles"].push_back({1, 4, 5});
  const InputPart surface = part("surface", skirted.dump());
  for (const Request& request : {Request{"clip", {surface}, {{"bbox", "2,-1,8,5"}}},
                                 Request{"simplify", {surface}, {{"max-error", "0"}}}}) {
    const Response r = run(request);
    EXPECT_GT(r.report["output"]["walls"], 0);
    EXPECT_EQ(r.report["accuracy"]["max_height_error"], 0) << request.operation;
    EXPECT_FALSE(warned(r, "height-check")) << request.operation;
    EXPECT_FALSE(warned(r, "skirts-left-out")) << request.operation;
  }
  const InputPart a_skirted = part("a", skirted.dump()), beside = part("b", square(5, 0, 10, 1, 0, ""));
  EXPECT_TRUE(warned(run({"add", {a_skirted, beside}}), "skirts-left-out"));
  EXPECT_TRUE(warned(run({"clip", {surface}, {{"bbox", "2,-1,8,5"}, {"grid", "0.5"}}}), "skirts-left-out"));
}

TEST(Execute, EmptyAndApart) {
  const std::string empty = R"({"type":"TIN","crs":"EPSG:25831","vertices":[],"triangles":[]})";
  EXPECT_EQ(run({"merge", {part("tiles", empty), part("tiles", a)}}).report["output"]["faces"], 2);
  EXPECT_EQ(refusal({"subtract", {part("minuend", a), part("subtrahend", empty)}}).code, "empty-surface");
  const std::string far = square(471000, 4380000, 100, 1, 0, utm);
  const Error apart = refusal({"subtract", {part("minuend", a), part("subtrahend", far)}});
  EXPECT_EQ(apart.code, "no-overlap");
  EXPECT_NE(std::string(apart.what()).find("900 m"), std::string::npos) << apart.what();
  EXPECT_EQ(refusal({"volume", {part("surface", a), part("reference", far)}}).code, "no-overlap");
  const Response r = run({"subtract", {part("minuend", a), part("subtrahend", far)}, {{"allow-empty", "true"}}});
  EXPECT_EQ(r.report["output"]["faces"], 0);
  EXPECT_TRUE(warned(r, "no-overlap"));
}

TEST(Execute, ARasterKeepsItsBoundInTheResultsCrs) {
  std::string grid = "ncols 60\nnrows 60\nxllcorner 2\nyllcorner 39\ncellsize 0.01\n";
  for (int j = 0; j < 60; ++j, grid += "\n")
    for (int i = 0; i < 60; ++i)
      grid += std::to_string(static_cast<int>(300 + 200 * std::sin(i * 0.13) * std::cos(j * 0.17))) + " ";
  const Response r = run({"triangulate",
                          {{"dem", "hills.asc", "", grid}},
                          {{"assume-crs", "EPSG:4326"}, {"target-crs", utm}, {"max-error", "5"}}});
  const auto& approximation = r.report["accuracy"]["approximation"];
  EXPECT_LE(approximation["measured"].get<double>(), 5);
  EXPECT_GT(approximation["measured"].get<double>(), 1);
  EXPECT_LT(r.report["output"]["vertices"].get<int>(), 1500);
  EXPECT_GT(r.report["reprojection"]["planarity_error"].get<double>(), 0);
}

TEST(Execute, RastersOnOneLatticeLeaveNoSlit) {
  const std::string head = "ncols 3\nnrows 3\nyllcorner 0\ncellsize 1\n";
  const std::string west = head + "xllcorner 0\n1 2 3\n4 5 6\n7 8 9\n",
                    east = head + "xllcorner 3\n4 4 4\n5 5 5\n6 6 6\n";
  const Response r = run({"merge", {{"tiles", "w.asc", "", west}, {"tiles", "e.asc", "", east}}});
  EXPECT_EQ(r.report["output"]["components"], 1);
  EXPECT_DOUBLE_EQ(r.report["output"]["area_2d"].get<double>(), 10);
  EXPECT_EQ(r.report["inputs"][1]["joined"], "w.asc + e.asc");
  EXPECT_EQ(r.report["seams"]["joined"], nlohmann::json({"w.asc + e.asc"}));
}

TEST(Execute, BadNumbersAndIndicesAreNeverRepaired) {
  const std::vector<std::string> bodies = {
      R"({"type":"TIN","vertices":[[0,0,1e400],[10,0,1],[0,10,1]],"triangles":[[0,1,2]]})",
      R"({"type":"TIN","vertices":[[0,0,1],[10,0,1],[0,10,1]],"triangles":[[0,1,3]]})",
      R"({"type":"TIN","vertices":[[0,0,1],[10,0,1],[0,10,1]],"triangles":[[0,1,)"};
  for (const std::string& body : bodies) {
    const Error e = refusal({"merge", {part("tiles", body, "bad.json")}});
    EXPECT_EQ(e.kind, ErrorKind::input) << body;
    EXPECT_NE(std::string(e.what()).find("bad.json"), std::string::npos) << e.what();
  }
}
