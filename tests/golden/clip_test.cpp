// SPDX-License-Identifier: GPL-3.0-or-later
// Regions of interest on real terrain, through the same plan and execute that the doors call. The data is not ours to
// pass on: where it does not lie beside the checkout these tests say so and skip.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "ops/request.hpp"
#include "support/checks.hpp"
#include "support/clip_checks.hpp"

namespace terrane {
namespace {

const std::filesystem::path data = std::filesystem::path(TERRANE_SOURCE_DIR) / ".." / "shared" / "data";

class RealRegions : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(data)) GTEST_SKIP() << "no real terrain beside the checkout (../shared/data)";
  }

  static Response run(const std::string& operation, std::vector<InputPart> inputs,
                      std::vector<std::pair<std::string, std::string>> parameters, const std::string& format) {
    Context context;
    return execute(plan({operation, std::move(inputs), std::move(parameters), format, {}, ""}), context);
  }

  static InputPart file(const std::string& slot, const std::string& path) {
    std::ifstream stream(data / path, std::ios::binary);
    std::ostringstream bytes;
    bytes << stream.rdbuf();
    return {slot, std::filesystem::path(path).filename(), "", bytes.str()};
  }

  static Tin decoded(const std::string& bytes) {
    Context context;
    return std::get<Tin>(format_named("obj")->read(bytes, {.name = "surface"}, context).surface);
  }

  /// A star around the middle of a surface, with a hole, as WKT.
  static std::string star(const Box& box) {
    const double x = 0.5 * (box.xmin + box.xmax), y = 0.5 * (box.ymin + box.ymax);
    support::Random random(21);
    std::string wkt = "POLYGON(";
    for (const double share : {0.48, 0.15}) {
      std::string ring;
      for (const Point& p : support::star({0, 0}, 0.5 * share, share, 24, random)) {
        char text[80];
        std::snprintf(text, sizeof text, "%s%.17g %.17g", ring.empty() ? "" : ",", x + p.x * (box.xmax - box.xmin),
                      y + p.y * (box.ymax - box.ymin));
        ring += text;
      }
      wkt += (wkt.ends_with('(') ? "(" : ",(") + ring + "," + ring.substr(0, ring.find(',')) + ")";
    }
    return wkt + ")";
  }

  /// Both sides of a star, and what a merge makes of them.
  static void expect_whole(const std::string& surface, const std::string& crs) {
    const Tin whole = decoded(surface);
    const auto side = [&](const char* name) {
      return run("clip", {{"surface", "surface.obj", "", surface}},
                 {{"region", star(bounds(whole))}, {"side", name}, {"assume-crs", crs}}, "obj");
    };
    const Response in = side("inside"), out = side("outside");
    for (const Response* r : {&in, &out}) {
      for (const char* key : {"inverted", "degenerate", "t_junctions", "non_manifold_edges"})
        EXPECT_EQ(r->report["topology"][key], 0) << key;
      EXPECT_LT(r->report["accuracy"]["max_height_error"].get<double>(), 1e-6);
      const auto& balance = r->report["area_balance"];
      EXPECT_LT(std::fabs(balance["residual"].get<double>()), 1e-9 * balance["expected"].get<double>());
    }
    const Response again = run("merge", {{"tiles", "in.obj", "", in.body}, {"tiles", "out.obj", "", out.body}},
                               {{"assume-crs", crs}}, "obj");
    EXPECT_EQ(again.report["output"]["walls"], 0);
    EXPECT_NEAR(again.report["output"]["area_2d"].get<double>() /
                    run("info", {{"surface", "surface.obj", "", surface}}, {{"assume-crs", crs}}, "json")
                        .report["area_2d"]
                        .get<double>(),
                1, 1e-9);
    const support::Sampler before(whole), after(decoded(again.body));
    for (const Point2 p : support::random_places(bounds(whole), 3000, 22)) {
      EXPECT_EQ(std::isnan(before(p)), std::isnan(after(p)));
      if (!std::isnan(before(p))) {
        EXPECT_NEAR(before(p), after(p), 1e-6);
      }
    }
  }
};

TEST_F(RealRegions, a_merge_of_the_clips_of_a_tile_is_the_tile) {
  for (const char* tile : {"tiles/N44W072_ne.tif", "tiles/S33W071_e.tif"})
    expect_whole(run("triangulate", {file("dem", tile)}, {{"max-error", "10"}}, "obj").body, "EPSG:4326");
}

}  // namespace
}  // namespace terrane
