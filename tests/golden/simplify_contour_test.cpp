// SPDX-License-Identifier: GPL-3.0-or-later
// Simplification and contours on real terrain, through the same plan and execute that the doors call. The data is not
// ours to pass on: where it does not lie beside the checkout these tests say so and skip.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/merge.hpp"
#include "core/simplify.hpp"
#include "core/simplify/deviation.hpp"
#include "ops/request.hpp"
#include "support/checks.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using Parameters = std::vector<std::pair<std::string, std::string>>;
const std::filesystem::path data = std::filesystem::path(TERRANE_SOURCE_DIR) / ".." / "shared" / "data";

class RealTerrainLines : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(data)) GTEST_SKIP() << "no real terrain beside the checkout (../shared/data)";
  }

  static std::string file(const std::string& path) {
    std::ifstream stream(data / path, std::ios::binary);
    std::ostringstream bytes;
    bytes << stream.rdbuf();
    return bytes.str();
  }
  static Response run(const std::string& operation, const std::string& name, const std::string& bytes,
                      Parameters parameters, const std::string& format) {
    Context context;
    const std::string slot = operation == "triangulate" ? "dem" : "surface";
    return execute(plan({operation, {{slot, name, "", bytes}}, std::move(parameters), format, {}, ""}), context);
  }
  static Tin decoded(const std::string& ply) {
    Context context;
    return std::get<Tin>(format_named("ply")->read(ply, {.name = "result"}, context).surface);
  }
};

TEST_F(RealTerrainLines, halves_simplified_apart_stay_within_the_bound_and_still_meet) {
  const std::string name = "frontrange_srtmgl3_w.tif";
  const std::string ply = run("convert", name, file("tiles/" + name), {}, "ply").body;
  const Tin whole = decoded(ply);
  const Response made = run("simplify", name, file("tiles/" + name), {{"max-error", "15"}}, "ply");
  EXPECT_LE(made.report["accuracy"]["approximation"]["measured"].get<double>(), 15);
  EXPECT_LE(made.report["accuracy"]["approximation"]["on_overlay"].get<double>(), 15 + 1e-6);
  EXPECT_LT(made.report["output"]["faces"].get<std::size_t>(), whole.faces.size() / 4);

  const Box box = bounds(whole);
  const double middle = 0.5 * (box.xmin + box.xmax);
  std::vector<Tin> halves;
  for (const bool west : {true, false}) {
    const Tin half = support::without(whole, [&](Point2 c) { return (c.x < middle) != west; });
    Context context;
    halves.push_back(simplify(half, {15}, context).tin);
    EXPECT_LE(largest_difference(half, halves.back(), context), 15 + 1e-6);
    EXPECT_EQ(support::wrong_with(halves.back()), "");
  }
  Context context;
  const Tin both = merge(halves, {}, context).surface.tin;
  EXPECT_EQ(both.faces.size(), halves[0].faces.size() + halves[1].faces.size()) << "vertex on vertex";
  EXPECT_LE(largest_difference(whole, both, context), 15 + 1e-6);
}

TEST_F(RealTerrainLines, contours_lie_on_the_surface) {
  for (const std::string path : {"epochs/fortbragg_dem_2004.tif", "tiles/S33W071_w.tif"}) {
    const std::string name = std::filesystem::path(path).filename(), bytes = file(path);
    const std::string ply = run("convert", name, bytes, {}, "ply").body;
    const Tin tin = decoded(ply);
    const support::Sampler z(tin);
    const auto lines = nlohmann::json::parse(
        run("contour", "t.ply", ply, {{"interval", path[0] == 'e' ? "1" : "100"}}, "geojson").body);
    EXPECT_GT(lines["features"].size(), 20u);
    double worst = 0;
    std::size_t outside = 0, points = 0;
    for (const auto& feature : lines["features"])
      for (const auto& p : feature["geometry"]["coordinates"]) {
        const double on = z({p[0], p[1]});
        ++points;
        if (std::isnan(on))
          ++outside;  // rounded across the border
        else
          worst = std::max(worst, std::fabs(on - p[2].get<double>()));
      }
    EXPECT_LE(worst, 1e-9 * 5000) << "1e-9 of the heights; what a rounded place makes of it on a slope in degrees";
    EXPECT_LT(outside, points / 100);
  }
}

}  // namespace
}  // namespace terrane
