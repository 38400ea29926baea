// SPDX-License-Identifier: GPL-3.0-or-later
#include "unit/io/reading.hpp"

namespace terrane {
namespace {

Raster numbers(int width, int height) {
  Raster r;
  r.width = width, r.height = height;
  r.x0 = 457000.25, r.y0 = 4372999.75, r.dx = 0.5, r.dy = 0.5;
  for (int k = 0; k < width * height; ++k) r.samples.push_back(k % 11 == 3 ? NAN : 100 + std::sin(k * 0.1) / 3);
  return r;
}

void expect_same(const Raster& a, const Raster& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.x0, b.x0);
  EXPECT_EQ(a.y0, b.y0);
  EXPECT_EQ(a.dx, b.dx);
  EXPECT_EQ(a.dy, b.dy);
  ASSERT_EQ(a.samples.size(), b.samples.size());
  for (std::size_t k = 0; k < a.samples.size(); ++k)
    ASSERT_TRUE(a.samples[k] == b.samples[k] || (std::isnan(a.samples[k]) && std::isnan(b.samples[k]))) << k;
}

Dataset there_and_back(const Raster& raster, const Crs& crs, const char* word) {
  Context context;
  const std::string bytes = write_raster(raster, crs, word, context);
  EXPECT_EQ(bytes, write_raster(raster, crs, word, context));
  EXPECT_TRUE(context.warnings.empty());
  return read(word, bytes, context);
}

TEST(RasterFile, HeightsAndPlacesComeBackToTheBit) {
  for (const char* word : {"tif", "asc"})
    for (const auto& [width, height] : {std::pair{7, 5}, {1, 1}, {300, 20}, {33, 700}})
      expect_same(std::get<Raster>(there_and_back(numbers(width, height), {}, word).surface), numbers(width, height));
}

TEST(RasterFile, OblongCells) {
  Raster r = numbers(4, 3);
  r.dy = 0.25;
  for (const char* word : {"tif", "asc"}) expect_same(std::get<Raster>(there_and_back(r, {}, word).surface), r);
}

TEST(RasterFile, GeoTiffsKeepTheCrsWithItsVerticalPart) {
  for (const char* id :
       {"EPSG:25831", "EPSG:25831+5773", "EPSG:4326", "EPSG:4979", "EPSG:2263+6360", "EPSG:4326+5773"}) {
    const Crs crs = Crs::parse(id), back = there_and_back(numbers(3, 3), crs, "tif").crs;
    ASSERT_TRUE(back.known()) << id;
    EXPECT_TRUE(back.same_plan(crs)) << id << " " << back.id();
    EXPECT_EQ(back.vertical_datum(), crs.vertical_datum()) << id;
    EXPECT_EQ(back.height_unit(), crs.height_unit()) << id;
  }
}

TEST(RasterFile, GeoTiffsCannotHoldALocalFrameAndSaySo) {
  Context context;
  write_raster(numbers(2, 2), Crs::parse("local:m"), "tif", context);
  ASSERT_EQ(context.warnings.size(), 1u);
  EXPECT_EQ(context.warnings[0].code, "crs-not-held");
}

TEST(RasterFile, AHeightThatIsTheNoDataValueIsNoVoid) {
  Raster r = numbers(2, 2);
  r.samples[0] = -9999;
  for (const char* word : {"tif", "asc"}) {
    const Dataset back = there_and_back(r, {}, word);
    EXPECT_NEAR(std::get<Raster>(back.surface).samples[0], -9999, 1e-11);
  }
}

TEST(RasterFile, NothingOfWhereAndWhen) {
  Context context;
  const std::string bytes = write_raster(numbers(5, 5), Crs::parse("EPSG:25831"), "tif", context);
  for (const char* word : {"vsimem", "/tmp", "202", "terrane"}) EXPECT_EQ(bytes.find(word), std::string::npos) << word;
}

TEST(LineLength, IsThatOfTheEllipsoid) {
  const Crs degrees = Crs::parse("EPSG:4326");
  EXPECT_NEAR(line_length(degrees, {0, 0}, {1, 0}), 111319.490793, 1e-5);  // along the equator: a * pi / 180
  EXPECT_NEAR(line_length(degrees, {7, 0}, {7, 90}), 10001965.729, 1e-2);  // a quarter of a meridian
  EXPECT_NEAR(line_length(degrees, {-180, 90}, {180, 90}), 0, 1e-6);
  EXPECT_EQ(line_length(Crs::parse("EPSG:25831"), {0, 0}, {3, 4}), 5);
  EXPECT_EQ(line_length({}, {0, 0}, {3, 4}), 5);
  const double whole = line_length(degrees, {2, 39}, {4.5, 41});
  double parts = 0;
  for (int k = 0; k < 10; ++k)
    parts += line_length(degrees, {2 + 0.25 * k, 39 + 0.2 * k}, {2 + 0.25 * (k + 1), 39 + 0.2 * (k + 1)});
  EXPECT_NEAR(whole, parts, 1e-6);
  EXPECT_THROW(line_length(degrees, {0, 89}, {0, 91}), Error);
}

}  // namespace
}  // namespace terrane
