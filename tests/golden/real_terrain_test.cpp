// SPDX-License-Identifier: GPL-3.0-or-later
// The main job on real terrain, through the same plan and execute that the doors call. The data is not ours to pass on:
// where it does not lie beside the checkout these tests say so and skip.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>

#include "core/merge.hpp"
#include "ops/request.hpp"
#include "support/checks.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using Parameters = std::vector<std::pair<std::string, std::string>>;
const std::filesystem::path data = std::filesystem::path(TERRANE_SOURCE_DIR) / ".." / "shared" / "data";

class RealTerrain : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(data)) GTEST_SKIP() << "no real terrain beside the checkout (../shared/data)";
  }

  static InputPart file(const std::string& slot, const std::string& path) {
    std::ifstream stream(data / path, std::ios::binary);
    std::ostringstream bytes;
    bytes << stream.rdbuf();
    return {slot, std::filesystem::path(path).filename(), "", bytes.str()};
  }
  static Response run(const std::string& operation, std::vector<InputPart> inputs, Parameters parameters,
                      const std::string& format) {
    Context context;
    return execute(plan({operation, std::move(inputs), std::move(parameters), format, {}, ""}), context);
  }
  static InputPart tin(const std::string& slot, const std::string& name, const Response& made) {
    return {slot, name + ".ply", "", made.body};
  }
  static Tin decoded(const Response& made) {
    Context context;
    return std::get<Tin>(format_named("ply")->read(made.body, {.name = "result"}, context).surface);
  }
  static void expect_clean(const nlohmann::json& report) {
    for (const char* key : {"inverted", "degenerate", "t_junctions", "non_manifold_edges"})
      EXPECT_EQ(report["topology"][key], 0) << key;
  }
  /// The bytes of a merge in the order given and reversed.
  static void expect_order_free(std::vector<InputPart> tiles, const Parameters& parameters) {
    const std::string forth = run("merge", tiles, parameters, "ply").body;
    std::reverse(tiles.begin(), tiles.end());
    EXPECT_EQ(forth, run("merge", tiles, parameters, "ply").body);
  }
};

TEST_F(RealTerrain, four_islands_stay_apart_and_keep_their_area) {
  std::vector<InputPart> tiles;
  double area = 0;
  int components = 0;
  for (const std::string name : {"mallorca", "menorca", "ibiza", "formentera"}) {
    const Response made = run("triangulate", {file("dem", "balearic/" + name + "_30s.tif")},
                              {{"max-error", "5"}, {"target-crs", "EPSG:25831"}}, "ply");
    area += made.report["output"]["area_2d"].get<double>();
    components += made.report["output"]["components"].get<int>();
    EXPECT_LE(made.report["accuracy"]["approximation"]["measured"], 5.0);
    tiles.push_back(tin("tiles", name, made));
  }
  const Response merged = run("merge", tiles, {}, "ply");
  expect_clean(merged.report);
  EXPECT_EQ(merged.report["output"]["components"], components);
  EXPECT_NEAR(merged.report["output"]["area_2d"].get<double>(), area, 1e-9 * area);
  expect_order_free(tiles, {{"overlap", "mean"}});
}

double median(std::vector<double> z) {
  std::sort(z.begin(), z.end());
  return (z[(z.size() - 1) / 2] + z[z.size() / 2]) / 2;
}

TEST_F(RealTerrain, overlapping_windows_follow_their_policy_at_100000_places) {
  std::vector<InputPart> tiles;
  std::vector<support::Sampler> heights;
  for (const std::string corner : {"nw", "ne", "sw", "se"}) {
    const Response made =
        run("triangulate", {file("dem", "balearic/window_" + corner + ".tif")}, {{"max-error", "10"}}, "ply");
    heights.emplace_back(decoded(made));
    tiles.push_back(tin("tiles", corner, made));
  }
  for (const std::string overlap : {"first", "last", "min", "max", "mean", "median", "sum"}) {
    SCOPED_TRACE(overlap);
    const Response merged = run("merge", tiles, {{"overlap", overlap}}, "ply");
    expect_clean(merged.report);
    EXPECT_LT(merged.report["accuracy"]["max_height_error"], 1e-8);
    EXPECT_EQ(merged.report["seams"]["pairs"].size(), 6u);  // all four overlap in the middle
    if (overlap != "first" && overlap != "last") expect_order_free(tiles, {{"overlap", overlap}});
    const Tin result = decoded(merged);
    const support::Sampler sampler(result);
    for (const Point2 at : support::random_places(bounds(result), 100000, 7)) {
      std::vector<double> z;
      for (const support::Sampler& tile : heights)
        if (const double h = tile(at); !std::isnan(h)) z.push_back(h);
      const double total = std::accumulate(z.begin(), z.end(), 0.0);
      ASSERT_FALSE(z.empty());
      const double wanted = overlap == "first"    ? z.front()
                            : overlap == "last"   ? z.back()
                            : overlap == "min"    ? *std::min_element(z.begin(), z.end())
                            : overlap == "max"    ? *std::max_element(z.begin(), z.end())
                            : overlap == "mean"   ? total / z.size()
                            : overlap == "median" ? median(z)
                                                  : total;
      ASSERT_NEAR(sampler(at), wanted, 1e-8) << at.x << " " << at.y;  // degrees: a slope of 1e4 m per degree
    }
  }
}

TEST_F(RealTerrain, quarters_that_were_moved_are_snapped_or_bridged) {
  // Each quarter lies some metres off, as after transformations that do not agree.
  std::vector<InputPart> tiles;
  for (int i = 0; i < 4; ++i) {
    const std::string corner = std::array{"nw", "ne", "sw", "se"}[i];
    const Response made =
        run("triangulate", {file("dem", "tiles/N44W072_" + corner + ".tif")}, {{"max-error", "40"}}, "json");
    auto moved = nlohmann::json::parse(made.body);
    for (auto& v : moved["vertices"]) {
      v[0] = v[0].get<double>() + 1e-4 * i + 2e-5 * std::sin(5000 * v[1].get<double>());
      v[1] = v[1].get<double>() - 1.3e-4 * (i / 2) - 3e-5 * std::sin(3000 * v[0].get<double>());
    }
    tiles.push_back({"tiles", corner + ".json", "", moved.dump()});
  }
  EXPECT_EQ(run("merge", tiles, {}, "ply").report["output"]["components"], 4);
  for (const auto& [parameter, distance] : {std::pair("snap", "45"), {"gap", "45"}}) {
    SCOPED_TRACE(parameter);
    const Response merged = run("merge", tiles, {{"overlap", "mean"}, {parameter, distance}}, "ply");
    expect_clean(merged.report);
    EXPECT_EQ(merged.report["output"]["components"], 1);
    EXPECT_EQ(merged.report["output"]["holes"], 0);
    EXPECT_LT(merged.report["accuracy"]["max_height_error"], 1e-8);
    expect_order_free(tiles, {{"overlap", "median"}, {parameter, distance}});
  }
  const Response leaned = run("merge", tiles, {{"overlap", "mean"}, {"snap", "45"}, {"wall-offset", "0.01"}}, "ply");
  expect_clean(leaned.report);
  EXPECT_EQ(leaned.report["output"]["walls"], 0);
}

TEST_F(RealTerrain, two_halves_of_mallorca_are_mallorca) {
  const Response halves =
      run("merge", {file("tiles", "balearic/mallorca_west_30s.tif"), file("tiles", "balearic/mallorca_east_30s.tif")},
          {{"overlap", "mean"}}, "ply");
  const Response whole = run("triangulate", {file("dem", "balearic/mallorca_30s.tif")}, {}, "ply");
  EXPECT_EQ(halves.body, whole.body);
  Context context;
  const InputPart dem = file("dem", "balearic/mallorca_30s.tif");
  const Raster raster = std::get<Raster>(format_named("tif")->read(dem.bytes, {.name = dem.name}, context).surface);
  const support::Sampler sampler(decoded(halves));
  int seen = 0;
  for (int j = 0; j < raster.height; ++j)
    for (int i = 0; i < raster.width; ++i)
      if (const double z = sampler(raster.place(i, j)); !std::isnan(z) && !std::isnan(raster.at(i, j))) {
        ++seen;
        EXPECT_EQ(z, raster.at(i, j));
      }
  EXPECT_GT(seen, 5000);
}

TEST_F(RealTerrain, mallorca_lies_on_top_of_the_sea_floor_unchanged) {
  const InputPart fine = file("tiles", "balearic/mallorca_30s.tif"),
                  coarse = file("tiles", "balearic/balearic_etopo5.tif");
  const Response merged = run("merge", {fine, coarse}, {{"overlap", "first"}}, "ply");
  expect_clean(merged.report);
  EXPECT_GT(merged.report["seams"]["pairs"][0]["jump"]["max_abs"], 100.0);
  const auto alone = [&](InputPart part) {
    part.slot = "dem";
    return decoded(run("triangulate", {part}, {}, "ply"));
  };
  const Tin island = alone(fine), result = decoded(merged);
  EXPECT_EQ(support::missing_vertices(island, result), 0u);
  const support::Sampler on_top(island), below(alone(coarse)), sampler(result);
  for (const Point2 at : support::random_places(bounds(result), 100000, 8)) {
    const double inside = on_top(at);
    ASSERT_NEAR(sampler(at), std::isnan(inside) ? below(at) : inside, 1e-8);
  }
}

TEST_F(RealTerrain, quarters_that_share_a_row_meet_without_a_crack) {
  std::vector<InputPart> rasters, tins;
  for (const std::string corner : {"nw", "ne", "sw", "se"}) {
    rasters.push_back(file("tiles", "tiles/N44W072_" + corner + ".tif"));
    InputPart dem = rasters.back();
    dem.slot = "dem";
    tins.push_back(tin("tiles", corner, run("triangulate", {dem}, {{"max-error", "10"}}, "ply")));
  }
  for (const auto& [tiles, parameters] : {std::pair(rasters, Parameters{{"overlap", "mean"}, {"max-error", "10"}}),
                                          std::pair(tins, Parameters{{"overlap", "mean"}})}) {
    const Response merged = run("merge", tiles, parameters, "ply");
    expect_clean(merged.report);
    EXPECT_EQ(merged.report["output"]["components"], 1);
    EXPECT_EQ(merged.report["output"]["holes"], 0);
    EXPECT_EQ(merged.report["output"]["walls"], 0);
    EXPECT_NEAR(merged.report["area_balance"]["actual"].get<double>(), 1, 1e-12);  // one degree by one degree
    expect_order_free(tiles, parameters);
  }
}

TEST_F(RealTerrain, seams_of_four_windows_are_ramped_under_every_policy) {
  std::vector<InputPart> tiles;
  for (const std::string corner : {"nw", "ne", "sw", "se"}) {
    const Response made = run("triangulate", {file("dem", "balearic/window_" + corner + ".tif")},
                              {{"max-error", "10"}, {"target-crs", "EPSG:25831"}}, "ply");
    tiles.push_back(tin("tiles", corner, made));
  }
  for (const std::string overlap : {"first", "last", "min", "max", "mean", "median", "sum"}) {
    SCOPED_TRACE(overlap);
    const Response walls = run("merge", tiles, {{"overlap", overlap}}, "ply");
    const Response ramps = run("merge", tiles, {{"overlap", overlap}, {"seam", "ramp"}}, "ply");
    expect_clean(ramps.report);
    EXPECT_LT(ramps.report["output"]["walls"].get<int>(), walls.report["output"]["walls"].get<int>() / 10 + 1)
        << "parts without room";
    EXPECT_LT(ramps.report["accuracy"]["max_height_error"], 1e-6);
    EXPECT_LT(ramps.report["ramps"]["area_2d"], 0.2 * ramps.report["output"]["area_2d"].get<double>())
        << "the sea has large faces";
    if (overlap != "first" && overlap != "last") expect_order_free(tiles, {{"overlap", overlap}, {"seam", "ramp"}});
  }
}

/// Two epochs of a gully, the newer one surveyed in its middle only: the part of a TIN in a box.
Tin within(const Tin& tin, const Box& box) {
  return support::without(
      tin, [&](Point2 c) { return c.x < box.xmin || c.x > box.xmax || c.y < box.ymin || c.y > box.ymax; });
}

TEST_F(RealTerrain, epochs_are_blended_without_a_cliff) {
  std::vector<Tin> epochs;
  for (const int year : {2016, 2004})
    epochs.push_back(decoded(run("triangulate", {file("dem", "epochs/fortbragg_dem_" + std::to_string(year) + ".tif")},
                                 {{"max-error", "0.2"}}, "ply")));
  const Tin survey = within(epochs[0], {597300, 150700, 597500, 150900});
  Context context;
  for (const BlendSide side : {BlendSide::both, BlendSide::inside, BlendSide::outside}) {
    SCOPED_TRACE(static_cast<int>(side));
    MergeOptions options{Overlap::blend};
    options.blend = {30, side, 0.02, {1, 1}};
    const Merged merged = merge({survey, epochs[1]}, options, context);
    EXPECT_LE(merged.blend.bound, 0.02);
    EXPECT_EQ(support::wrong_with(merged.surface.tin), "");
    EXPECT_EQ(merged.surface.wall_area, 0) << "no cliff at either end of the band";
    const support::Sampler z(merged.surface.tin), of_survey(survey), before(epochs[1]);
    int far = 0;
    for (const Point2 p : support::random_places({597220, 150600, 597620, 151000}, 20000, 4)) {
      const double depth = std::min({p.x - 597300, 597500 - p.x, p.y - 150700, 150900 - p.y});
      if (depth > 40) {
        EXPECT_NEAR(z(p), of_survey(p), 0.02);
      }
      if (depth < -40) {
        EXPECT_NEAR(z(p), before(p), 0.02);
      }
      far += std::fabs(depth) > 40;
    }
    EXPECT_GT(far, 8000);
  }
}

TEST_F(RealTerrain, volumes_between_three_epochs_add_up) {
  const auto epoch = [](const std::string& slot, int year) {
    return file(slot, "epochs/fortbragg_dem_" + std::to_string(year) + ".tif");
  };
  // SOURCES.md: exact fills and cuts over triangles with one fixed diagonal and with the other. Ours have the flatter
  // diagonal.
  struct Reference {
    int before, after;
    double fill, cut;
  };
  const std::vector<Reference> table = {
      {2004, 2012, 23917.5, 3494.6}, {2012, 2016, 7790, 3143.3}, {2004, 2016, 28250.5, 3180.9}};
  const auto integral_by_cells = [&](int year) {
    Context context;
    const InputPart part = epoch("dem", year);
    const Raster r = std::get<Raster>(format_named("tif")->read(part.bytes, {.name = part.name}, context).surface);
    double sum = 0;
    for (int j = 0; j + 1 < r.height; ++j)
      for (int i = 0; i + 1 < r.width; ++i) {
        const double ul = r.at(i, j), ur = r.at(i + 1, j), ll = r.at(i, j + 1), lr = r.at(i + 1, j + 1);
        const bool rising = std::fabs(ll - ur) <= std::fabs(lr - ul);
        sum += (ul + ur + ll + lr + (rising ? ll + ur : lr + ul)) / 6;
      }
    return sum;
  };
  std::vector<double> net;
  for (const Reference& r : table) {
    const nlohmann::json report = nlohmann::json::parse(
        run("volume", {epoch("surface", r.after), epoch("reference", r.before)}, {}, "json").body);
    const nlohmann::json& row = report["rows"][0];
    EXPECT_NEAR(row["fill"]["volume"], r.fill, 1e-3 * r.fill);
    EXPECT_NEAR(row["cut"]["volume"], r.cut, 1e-3 * r.cut);
    const double after = integral_by_cells(r.after), before = integral_by_cells(r.before);
    EXPECT_NEAR(row["net_volume"], after - before, 1e-13 * (after + before));
    EXPECT_LE(report["identity_residual"].get<double>(), 1e-9 * row["net_volume"].get<double>());
    EXPECT_EQ(row["coverage"]["overlap_area_2d"], 201601);
    net.push_back(row["net_volume"]);
  }
  EXPECT_NEAR(net[0] + net[1], net[2], 1e-9 * net[2]);

  const Response forth = run("subtract", {epoch("minuend", 2012), epoch("subtrahend", 2004)}, {}, "ply");
  const Response back = run("subtract", {epoch("minuend", 2004), epoch("subtrahend", 2012)}, {}, "ply");
  const Tin zero = decoded(run("add", {tin("a", "forth", forth), tin("b", "back", back)}, {}, "ply"));
  EXPECT_TRUE(std::all_of(zero.vertices.begin(), zero.vertices.end(), [](const Point& p) { return p.z == 0; }));
}

}  // namespace
}  // namespace terrane
