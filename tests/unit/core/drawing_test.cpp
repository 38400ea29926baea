// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "core/map_sheet.hpp"
#include "core/picture/canvas.hpp"
#include "core/picture/colour_scale.hpp"
#include "core/picture/lettering.hpp"
#include "core/profile_chart.hpp"
#include "core/ticks.hpp"
#include "core/triangulate.hpp"
#include "tests/support/ascii_raster.hpp"

using namespace terrane;
using terrane::testing::ascii_raster;

namespace {

Picture blank(int width, int height, std::uint8_t value = 255) {
  Picture p{width, height, {}};
  p.rgba.assign(static_cast<std::size_t>(width) * height * 4, value);
  return p;
}

const std::uint8_t* pixel(const Picture& p, int i, int j) { return p.rgba.data() + 4 * (j * p.width + i); }

double lightness(Colour c) { return 0.3 * c.r + 0.59 * c.g + 0.11 * c.b; }

Tin hills() {
  Context context;
  return triangulate(ascii_raster({"0123", "1256", "2.77", "1479"}, 10), {}, context).tin;
}

std::size_t opaque(const Picture& p, int x0, int y0, int x1, int y1) {
  std::size_t count = 0;
  for (int j = y0; j < y1; ++j)
    for (int i = x0; i < x1; ++i) count += pixel(p, i, j)[3] != 0;
  return count;
}

}  // namespace

TEST(Ticks, AreRoundAndWithin) {
  const Ticks t = ticks(-3, 17, 5);
  EXPECT_EQ(t.at, (std::vector<double>{0, 5, 10, 15}));
  EXPECT_EQ(t.label(5), "5");
  EXPECT_EQ(ticks(0, 0.7, 4).label(0.2), "0.2");
  EXPECT_EQ(ticks(0, 1, 5).at.size(), 6u);
  EXPECT_EQ(ticks(4.38e6, 4.39e6, 5).label(4.382e6), "4382000");
}

TEST(Ticks, SignsAreTrueOnes) {
  const Ticks t = ticks(-2, 2, 4);
  EXPECT_EQ(t.label(-1, true),
            "\xE2\x88\x92"
            "1");
  EXPECT_EQ(t.label(1, true), "+1");
  EXPECT_EQ(t.label(0, true), "0");
  EXPECT_EQ(t.label(-1e-17, true), "0");
}

TEST(Ticks, OneOfOneHeight) {
  EXPECT_EQ(ticks(5, 5, 6).at, (std::vector<double>{5}));
  EXPECT_EQ(ticks(0, 0, 6).label(0), "0");
}

TEST(Ticks, RoundDown) {
  EXPECT_EQ(round_down(7.3), 5);
  EXPECT_EQ(round_down(5), 5);
  EXPECT_EQ(round_down(4.9), 2);
  EXPECT_DOUBLE_EQ(round_down(0.019), 0.01);
  EXPECT_EQ(round_down(1000), 1000);
}

TEST(Lettering, EveryCharacterHasAShapeOfItsWidth) {
  for (int c = '!'; c < 127; ++c) {
    const Lettering l = lettering(std::string(1, static_cast<char>(c)));
    EXPECT_FALSE(l.strokes.empty()) << c;
    EXPECT_GE(l.width, 0) << c;
    for (const auto& line : l.strokes)
      for (const Point2& p : line) {
        EXPECT_TRUE(p.x > -0.35 && p.x < l.width + 0.12 && p.y > -0.45 && p.y < 1.2) << static_cast<char>(c);
      }
  }
}

TEST(Lettering, TextsAddUp) {
  EXPECT_GT(lettering("ab").width, lettering("a").width + lettering("b").width);
  EXPECT_EQ(lettering("").width, 0);
  EXPECT_EQ(lettering("1").width, lettering("7").width);  // figures stand below each other
  EXPECT_EQ(lettering("\xC3\xA9").strokes.size(), 1u);    // a box, not two
  EXPECT_EQ(lettering("\xFF\xE2").strokes.size(), 2u);    // bytes that are no UTF-8
}

TEST(Canvas, StrokesDoNotDarkenWhereTheyCross) {
  Picture p = blank(40, 40);
  Canvas(p).stroke({{{5, 20}, {35, 20}}, {{20, 5}, {20, 35}}}, 4, {0, 0, 0}, 0.5);
  EXPECT_EQ(pixel(p, 20, 20)[0], pixel(p, 10, 20)[0]);
  EXPECT_NEAR(pixel(p, 10, 20)[0], 128, 2);
  EXPECT_EQ(pixel(p, 10, 10)[0], 255);
}

TEST(Canvas, EverythingBeyondThePictureIsCutOff) {
  Picture p = blank(20, 10, 0);
  Canvas canvas(p);
  canvas.stroke({{{-1000, -50}, {1000, 70}}}, 3, {1, 0, 0});
  canvas.text(-15, 5, "outside", 8, {0, 0, 0}, Anchor::left, 2);
  canvas.fill(-5, -5, 200, 200, {0, 1, 0});
  canvas.blend(20, 3, {0, 0, 0}, 1);
  EXPECT_EQ(p.rgba.size(), 800u);
}

TEST(Canvas, BlendingOnNothingKeepsTheColour) {
  Picture p = blank(1, 1, 0);
  Canvas(p).blend(0, 0, {1, 0.5, 0}, 0.5);
  EXPECT_EQ(pixel(p, 0, 0)[0], 255);
  EXPECT_NEAR(pixel(p, 0, 0)[3], 128, 1);
}

TEST(ColourScale, ElevationGetsLighterUpwardsOnEitherSideOfTheSea) {
  const ColourScale c = elevation_colours(-2000, 3000);
  for (int z = -2000; z < -40; z += 40) EXPECT_LT(lightness(c(z)), lightness(c(z + 39))) << z;
  for (int z = 0; z < 2960; z += 40) EXPECT_LT(lightness(c(z)), lightness(c(z + 40))) << z;
  EXPECT_GT(c(-1).b, c(-1).r);
  EXPECT_LT(c(1).b, c(1).g);
  EXPECT_GT(lightness(c(-1)), lightness(c(1)) + 0.2);  // the shore can be seen
}

TEST(ColourScale, DivergingIsWhiteAtZeroRedBelowBlueAbove) {
  const ColourScale c = diverging_colours(3);
  EXPECT_GT(lightness(c(0)), 0.95);
  EXPECT_GT(c(-2).r, c(-2).b + 0.3);
  EXPECT_GT(c(2).b, c(2).r + 0.3);
  for (const double z : {0.5, 1.0, 2.0, 2.9}) EXPECT_NEAR(lightness(c(z)), lightness(c(-z)), 0.2);
  EXPECT_EQ(c(3).b, c(100).b);
}

TEST(MapSheet, TheLegendIsBesideTheMapAndTheWholeHasTheSize) {
  Context context;
  ShadeOptions options;
  options.size = 600;
  options.colours = elevation_colours(0, 90);
  SheetOptions sheet{.title = "Height (m)", .low = 0, .high = 90, .ground_per_unit = 1, .ground_unit = "m"};
  const Picture p = map_sheet(hills(), options, sheet, context);
  EXPECT_EQ(std::max(p.width, p.height), 600);
  EXPECT_EQ(pixel(p, 0, 0)[3], 0);
  EXPECT_GT(opaque(p, p.width - 90, 0, p.width, p.height), 500u);  // the colour bar
  EXPECT_GT(opaque(p, 0, p.height - 25, 300, p.height), 50u);      // the scale bar
  ShadeOptions map = options;
  map.size = 150;
  EXPECT_EQ(map_sheet(hills(), map, sheet, context).width, 150);  // no room
}

TEST(MapSheet, ThinSurfacesLeaveRoomForTheBars) {
  Context context;
  for (const Point2 extent : {Point2{1000, 1}, Point2{1, 1000}}) {
    const Tin tin{{{0, 0, 0}, {extent.x, 0, 1}, {extent.x, extent.y, 2}, {0, extent.y, 3}}, {{0, 1, 2}, {0, 2, 3}}};
    ShadeOptions options;
    options.size = 800;
    options.colours = elevation_colours(0, 3);
    const Picture p = map_sheet(tin, options, {.title = "Height (m)", .high = 3, .ground_per_unit = 1}, context);
    EXPECT_LE(std::max(p.width, p.height), 800);
    EXPECT_GE(std::min(p.width, p.height), 100);
  }
}

TEST(Hillshade, WiresDarkenTheEdges) {
  Context context;
  const Tin tin{{{0, 0, 1}, {10, 0, 1}, {10, 10, 1}, {0, 10, 1}}, {{0, 1, 2}, {0, 2, 3}}};
  const Picture plain = hillshade(tin, {.size = 100}, context);
  const Picture wired = hillshade(tin, {.size = 100, .wireframe = true}, context);
  EXPECT_LT(pixel(wired, 50, 49)[0] + 40, pixel(plain, 50, 49)[0]);
  EXPECT_EQ(pixel(wired, 20, 50)[0], pixel(plain, 20, 50)[0]);
}

TEST(ProfileChart, HasAPanelPerLine) {
  const Tin tin = hills();
  const FaceGrid grid(tin);
  const std::vector<const FaceGrid*> grids = {&grid};
  const std::vector<Point2> line = {{-1, 1}, {4, 2}};
  Context context;
  const Section s = section(line, grids, context);
  ChartPanel panel{&s, {}, "Line"};
  for (std::size_t k = 0; k < s.rows.size(); ++k) panel.distance.push_back(5 * s.rows[k].along);
  const ChartOptions options{.size = 400, .names = {"hills.tif"}, .length_unit = "m", .height_unit = "m"};
  const std::vector<ChartPanel> one = {panel}, three = {panel, panel, panel};
  const Picture a = profile_chart(one, options), b = profile_chart(three, options);
  EXPECT_EQ(a.width, 400);
  EXPECT_GT(b.height, 2 * a.height - 60);
  std::size_t blue = 0;
  for (std::size_t k = 0; k < a.rgba.size(); k += 4) blue += a.rgba[k] < 60 && a.rgba[k + 2] > 140;
  EXPECT_GT(blue, 80u);
  EXPECT_EQ(a.rgba, profile_chart(one, options).rgba);
}

TEST(ProfileChart, NothingToShowIsStillAChart) {
  const Section s{1, {{0, 0, {0, 0}}, {0, 1, {1, 0}}}, {NAN, NAN}};
  const std::vector<ChartPanel> panels = {{&s, {0, 1}, ""}};
  EXPECT_GT(profile_chart(panels, {.size = 300, .names = {"x"}}).height, 100);
}
