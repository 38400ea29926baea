// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/shade.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "core/triangulate.hpp"
#include "tests/support/ascii_raster.hpp"

using namespace terrane;
using terrane::testing::ascii_raster;

namespace {

Tin tin_of(const Raster& dem) {
  Context context;
  return triangulate(dem, {}, context).tin;
}

Picture picture_of(const Tin& tin, const ShadeOptions& options) {
  Context context;
  return hillshade(tin, options, context);
}

const std::uint8_t* pixel(const Picture& p, int i, int j) { return p.rgba.data() + 4 * (j * p.width + i); }
int brightness(const std::uint8_t* c) { return c[0] + c[1] + c[2]; }

}  // namespace

TEST(Shade, LongerSideHasTheSizeAndNorthIsUp) {
  // A void in the north-west.
  const Picture p = picture_of(tin_of(ascii_raster({"..000", "00000", "00000"})), {.size = 80});
  EXPECT_EQ(p.width, 80);
  EXPECT_EQ(p.height, 40);
  ASSERT_EQ(p.rgba.size(), 80u * 40 * 4);
  EXPECT_EQ(pixel(p, 2, 2)[3], 0);
  EXPECT_EQ(pixel(p, 77, 2)[3], 255);
  EXPECT_EQ(pixel(p, 2, 37)[3], 255);
}

TEST(Shade, TransparentExactlyOutsideTheDomain) {
  const Picture p = picture_of(tin_of(ascii_raster({"0.00", "0000", "0000"})), {.size = 300});
  std::size_t opaque = 0;
  for (std::size_t k = 3; k < p.rgba.size(); k += 4) opaque += p.rgba[k] == 255;
  EXPECT_NEAR(opaque / (300.0 * 200.0), 5.0 / 6, 0.01);  // five of six cells' worth: four whole and two halves
}

TEST(Shade, SlopesFacingTheLightAreBrighter) {
  // A ridge from south-west to north-east; the light comes from the north-west.
  const Tin tin = tin_of(ascii_raster({"01234", "12343", "23432", "34321", "43210"}));
  const Picture p = picture_of(tin, {.size = 100});
  EXPECT_GT(brightness(pixel(p, 30, 30)), brightness(pixel(p, 70, 70)) + 100);
  const Picture turned = picture_of(tin, {.size = 100, .azimuth_deg = 135});
  EXPECT_LT(brightness(pixel(turned, 30, 30)) + 100, brightness(pixel(turned, 70, 70)));
}

TEST(Shade, SeaIsBlueAndLandIsNot) {
  Tin tin = tin_of(ascii_raster({"0009", "0009", "0009"}, 100));
  for (Point& p : tin.vertices) p.z -= 300;
  const Picture p = picture_of(tin, {.size = 90});
  EXPECT_GT(pixel(p, 10, 30)[2], pixel(p, 10, 30)[0] + 30);
  EXPECT_LE(pixel(p, 88, 30)[2], pixel(p, 88, 30)[0] + 5);
}

TEST(Shade, FlatSurfacesHaveOneColour) {
  const Picture p = picture_of(tin_of(ascii_raster({"777", "777"})), {.size = 64});
  for (std::size_t k = 4; k < p.rgba.size(); k += 4) {
    ASSERT_TRUE(std::equal(p.rgba.begin(), p.rgba.begin() + 4, p.rgba.begin() + static_cast<std::ptrdiff_t>(k)));
  }
}

TEST(Shade, XFactorKeepsShapes) {
  const Picture p = picture_of(tin_of(ascii_raster({"000", "000", "000"})), {.size = 100, .x_factor = 0.5});
  EXPECT_EQ(p.width, 50);
  EXPECT_EQ(p.height, 100);
}

TEST(Shade, UnitsOfHeightDoNotChangeThePicture) {
  const Raster metres = ascii_raster({"0189", "1765", "2345", "9876"});
  Raster decimetres = metres;
  for (double& z : decimetres.samples) z *= 8;
  EXPECT_EQ(picture_of(tin_of(metres), {.size = 64}).rgba,
            picture_of(tin_of(decimetres), {.size = 64, .z_factor = 8}).rgba);
}

TEST(Shade, NothingOfNothing) {
  EXPECT_EQ(picture_of({}, {}).rgba.size(), 0u);
  const Tin wall{{{0, 0, 0}, {0, 0, 5}, {0, 1, 0}}, {{0, 1, 2}}};
  for (const std::uint8_t byte : picture_of(wall, {.size = 10}).rgba) EXPECT_EQ(byte, 0);
}

TEST(Shade, RefusesSizesNoOneMeans) {
  const Tin tin = tin_of(ascii_raster({"00", "00"}));
  EXPECT_THROW(picture_of(tin, {.size = 0}), Error);
  EXPECT_THROW(picture_of(tin, {.size = 1'000'000}), Error);
}
