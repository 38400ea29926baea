// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/resource.h>

#include "unit/io/reading.hpp"
#include "unit/io/tiff.hpp"

namespace terrane {
namespace {

const std::vector<float> six = {1, 2, 3, 4, 5, 6};

void expect_samples(const Raster& raster, const Array<double>& samples) {
  ASSERT_EQ(raster.samples.size(), samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (std::isnan(samples[k]))
      EXPECT_TRUE(std::isnan(raster.samples[k])) << k;
    else
      EXPECT_EQ(raster.samples[k], samples[k]) << k;
  }
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(GeoTiff, SamplesAreCellCentres) {
  Context context;
  const Dataset data = read("tif", tiff(3, 2, six), context);
  const Raster& raster = std::get<Raster>(data.surface);
  EXPECT_EQ(raster.width, 3);
  EXPECT_EQ(raster.height, 2);
  EXPECT_EQ(raster.x0, 500005);
  EXPECT_EQ(raster.y0, 4399990);
  EXPECT_EQ(raster.dx, 10);
  EXPECT_EQ(raster.dy, 20);
  expect_samples(raster, {1, 2, 3, 4, 5, 6});
  EXPECT_EQ(data.crs.id(), "EPSG:25831");
  EXPECT_TRUE(context.warnings.empty());
}

TEST(GeoTiff, PointRastersLieOnTheirTiePoint) {
  const Raster raster = read_raster(
      "tif", tiff(3, 2, six, {{34735, shorts({1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 2, 3072, 0, 1, 25831})}}));
  EXPECT_EQ(raster.x0, 500000);
  EXPECT_EQ(raster.y0, 4400000);
}

TEST(GeoTiff, SouthUpAndEastFirstAreTurned) {
  const Raster raster = read_raster(
      "tif",
      tiff(3, 2, six,
           {{33550, {}}, {33922, {}}, {34264, doubles({-10, 0, 0, 530, 0, 20, 0, 100, 0, 0, 0, 0, 0, 0, 0, 1})}}));
  EXPECT_EQ(raster.x0, 505);
  EXPECT_EQ(raster.y0, 130);
  expect_samples(raster, {6, 5, 4, 3, 2, 1});
}

TEST(GeoTiff, NoDataAndNanAreVoids) {
  expect_samples(read_raster("tif", tiff(3, 2, {1, -9999, 3, NAN, 5, 6}, {{42113, text("-9999")}})),
                 {1, nan, 3, nan, 5, 6});
  expect_samples(read_raster("tif", tiff(3, 2, {1, -3.4028234663852886e+38f, 3, 0, 5, 6},
                                         {{42113, text("-3.40282346638529e+38")}})),
                 {1, nan, 3, 0, 5, 6});
}

TEST(GeoTiff, ScaleAndOffsetApply) {
  const std::string metadata =
      "<GDALMetadata><Item name=\"OFFSET\" sample=\"0\" role=\"offset\">100</Item><Item name=\"SCALE\" sample=\"0\" "
      "role=\"scale\">0.5</Item></GDALMetadata>";
  expect_samples(read_raster("tif", tiff(3, 2, six, {{42112, text(metadata)}})), {100.5, 101, 101.5, 102, 102.5, 103});
}

TEST(GeoTiff, TheUnitOfHeightsIsToldWhereTheCrsSaysAnother) {
  const auto unit = [](const std::string& said, bool located, Context& context) {
    std::map<std::uint16_t, TiffTag> changes = {
        {42112, text("<GDALMetadata><Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">" + said +
                     "</Item></GDALMetadata>")}};
    if (!located) changes[34735] = shorts({});
    return read("tif", tiff(3, 2, six, changes), context).height_unit;
  };
  Context context;
  EXPECT_EQ(unit("ft", true, context), "ft");
  EXPECT_EQ(unit("US survey foot", true, context), "ftUS");
  EXPECT_EQ(unit("metre", true, context), "");
  EXPECT_EQ(unit("metre", false, context), "m");
  EXPECT_EQ(unit("ft", false, context), "ft");
  EXPECT_TRUE(context.warnings.empty());
  EXPECT_EQ(unit("fathom", true, context), "");
  ASSERT_EQ(context.warnings.size(), 1u);
  EXPECT_EQ(context.warnings[0].code, "unknown-unit");
}

TEST(GeoTiff, VoidsThatAreNotDeclaredAreHeightsAndAWarning) {
  const std::vector<float> samples = {1, 2, -9999, 4, -9999, 6};
  Context context;
  const Dataset data = read("tif", tiff(3, 2, samples), context);
  EXPECT_EQ(std::get<Raster>(data.surface).at(2, 0), -9999);
  ASSERT_EQ(context.warnings.size(), 1u);
  EXPECT_EQ(context.warnings[0].code, "undeclared-voids");
  EXPECT_EQ(context.warnings[0].message.substr(0, 23), "2 samples are -9999, wh");
  Context declared;
  read("tif", tiff(3, 2, samples, {{42113, text("-9999")}}), declared);
  EXPECT_TRUE(declared.warnings.empty());
  Context lowest;
  read("tif", tiff(3, 2, {1, 2, 3, std::numeric_limits<float>::lowest(), 5, 6}), lowest);
  EXPECT_EQ(lowest.warnings.size(), 1u);
}

TEST(GeoTiff, CompoundCrsSurvives) {
  Context context;
  const Dataset data =
      read("tif",
           tiff(3, 2, six,
                {{34735, shorts({1, 1, 0, 4, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 25831, 4096, 0, 1, 5773})}}),
           context);
  EXPECT_EQ(data.crs.id(), "EPSG:25831+5773");
}

TEST(GeoTiff, BadOnesAreRefused) {
  EXPECT_COMPLAINT(complaint("tif", ""), "wrong-magic", "no TIFF");
  EXPECT_COMPLAINT(complaint("tif", "<VRTDataset rasterXSize=\"1\" rasterYSize=\"1\"/>"), "wrong-magic", "no TIFF");
  EXPECT_COMPLAINT(complaint("tif", tiff(3, 2, {1, 2, static_cast<float>(HUGE_VAL), 4, 5, 6})), "not-finite",
                   "column 2, row 0");
  EXPECT_COMPLAINT(complaint("tif", tiff(3, 2, six, {{33550, {}}, {33922, {}}})), "no-georeference", "");
  EXPECT_COMPLAINT(
      complaint("tif", tiff(3, 2, six,
                            {{33550, {}},
                             {33922, {}},
                             {34264, doubles({10, 1, 0, 500000, 1, -20, 0, 100, 0, 0, 0, 0, 0, 0, 0, 1})}})),
      "rotated", "");
  EXPECT_COMPLAINT(complaint("tif", tiff(3, 2, six, {{33550, doubles({nan, 20, 0})}})), "bad-number", "");
  EXPECT_COMPLAINT(complaint("tif", tiff(3, 2, six, {{33922, doubles({0, 0, 0, HUGE_VAL, 0, 0})}})), "bad-number", "");
}

TEST(GeoTiff, CutAnywhereItIsRefused) {
  const std::string bytes = tiff(3, 2, six);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const Error error = complaint("tif", std::string_view(bytes).substr(0, length));
    EXPECT_EQ(error.kind, ErrorKind::input) << length << ": " << error.what();
  }
  EXPECT_COMPLAINT(complaint("tif", tiff(3, 2, six, {{273, longs({100'000})}})), "truncated", "row 0");
}

long peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

TEST(GeoTiff, AFewBytesTakeNoGigabytes) {
  const long before = peak_megabytes();
  for (std::uint32_t size : {40'000u, 200'000u, 2'000'000'000u})
    for (std::uint16_t compression : {1, 5, 8, 50000}) {
      const Error error = complaint(
          "tif",
          tiff(1, 1, {1},
               {{256, longs({size})}, {257, longs({size})}, {278, longs({size})}, {259, shorts({compression})}}));
      EXPECT_TRUE(error.kind == ErrorKind::input || error.kind == ErrorKind::limit) << error.what();
    }
  const Error error = complaint("tif", tiff(3, 2, six), {.name = "bad.file", .max_samples = 5});
  EXPECT_EQ(error.kind, ErrorKind::limit);
  EXPECT_LT(peak_megabytes() - before, 200);
}

TEST(Hgt, ItsNameIsItsPlace) {
  std::string bytes(2 * 1201 * 1201, '\0');
  bytes[0] = 1;       // 256 in the north-west
  bytes[2] = '\x80';  // -32768 beside it
  const Raster raster = read_raster("hgt", bytes, "S33W071.hgt");
  EXPECT_EQ(raster.x0, -71);
  EXPECT_EQ(raster.y0, -32);
  EXPECT_EQ(raster.place(1200, 1200), (Point2{-70, -33}));
  EXPECT_EQ(raster.samples[0], 256);
  EXPECT_TRUE(std::isnan(raster.samples[1]));
  EXPECT_EQ(raster.samples[2], 0);
  EXPECT_EQ(read_raster("hgt", bytes, "folder/n44e007.SRTMGL1.hgt").x0, 7);
  for (const char* name : {"", "tile.hgt", "N4W072.hgt", "N44W0722.hg", "X44W072.hgt", "N99W072.hgt"}) {
    Context context;
    try {
      read("hgt", bytes, context, name);
      EXPECT_STREQ(name, "N44W0722.hg");  // seven characters are enough
    } catch (const Error& error) {
      EXPECT_EQ(error.code, "no-place") << name;
    }
  }
  EXPECT_EQ(complaint("hgt", std::string_view(bytes).substr(1), {.name = "N44W072.hgt"}).code, "truncated");
  EXPECT_EQ(complaint("hgt", "", {.name = "N44W072.hgt"}).code, "truncated");
}

const std::string grid = "ncols 3\nNROWS 2\nxllcorner 100\nyllcorner 200\ncellsize 10\nNODATA_value -1\n";

TEST(AsciiGrid, ReadsCornersAndCentres) {
  const Raster raster = read_raster("asc", grid + "1 2 3\n4 -1 6.5");
  EXPECT_EQ(raster.x0, 105);
  EXPECT_EQ(raster.y0, 215);
  EXPECT_EQ(raster.dx, 10);
  expect_samples(raster, {1, 2, 3, 4, nan, 6.5});
  const Raster centred = read_raster(
      "asc",
      "ncols 3\r\nnrows 2\r\nxllcenter 100\r\nyllcenter 200\r\ndx 10\r\ndy 5\r\nnodata_value nan\r\n1 2 3 4 NaN 6\r\n");
  EXPECT_EQ(centred.x0, 100);
  EXPECT_EQ(centred.y0, 205);
  expect_samples(centred, {1, 2, 3, 4, nan, 6});
}

TEST(AsciiGrid, AHeaderThatIsCutOffIsTruncated) {
  const std::string whole = "ncols 3\nnrows 3\nxllcenter 0\nyllcenter 0\ncellsize 10\n";
  for (const std::size_t length : {9u, 14u, 18u, 25u, 40u, 44u})
    EXPECT_COMPLAINT(complaint("asc", whole.substr(0, length)), "truncated", "bad.file");
  EXPECT_COMPLAINT(complaint("asc", "ncols 3\nfoo 3\n"), "bad-header", "header");
  EXPECT_EQ(read_raster("asc", "\xEF\xBB\xBF" + whole + "1 2 3 4 5 6 7 8 9").samples[4], 5);
}

TEST(AsciiGrid, WhatNoTinCanHoldIsRefusedByName) {
  const auto grid = [](const std::string& x, const std::string& cell, const std::string& height) {
    return "ncols 2\nnrows 2\nxllcenter " + x + "\nyllcenter 0\ncellsize " + cell + "\n1 2 3 " + height + "\n";
  };
  EXPECT_COMPLAINT(complaint("asc", grid("0", "10", "1e300")), "not-finite", "row 1, column 1");
  EXPECT_COMPLAINT(complaint("asc", grid("1e8", "1e-9", "4")), "cell-size", "1e-09 x 1e-09");
  EXPECT_COMPLAINT(complaint("asc", grid("0", "1e307", "4")), "cell-size", "1e+307 x 1e+307");
}

TEST(AsciiGrid, BadOnesAreRefused) {
  EXPECT_COMPLAINT(complaint("asc", grid + "1.25 2.25 3.25\n4 5"), "truncated", "row 1, column 2");
  EXPECT_COMPLAINT(complaint("asc", grid + "1 2 3\n4 5 6 7"), "bad-grid", "");
  for (const char* number : {"nan", "inf", "1e400", "x", "1,5"})
    EXPECT_COMPLAINT(complaint("asc", grid + "1 2 3 4 " + number + " 6"), "bad-number", "row 1, column 1");
  EXPECT_COMPLAINT(complaint("asc", ""), "bad-header", "ncols");
  EXPECT_COMPLAINT(complaint("asc", "hello"), "wrong-magic", "header");
  for (const char* line : {"ncols 0", "ncols -3", "ncols 2.5", "ncols x", "ncols 1e12"})
    EXPECT_COMPLAINT(complaint("asc", std::string(line) + "\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2"),
                     "bad-number", "ncols");
  EXPECT_COMPLAINT(complaint("asc", "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 0\n1 2"), "bad-number",
                   "cellsize");
  EXPECT_COMPLAINT(complaint("asc", "ncols 2\nnrows 1\nxllcorner 0\ncellsize 1\n1 2"), "bad-header", "yllcorner");
  EXPECT_COMPLAINT(complaint("asc", "ncols 2\nncols 2\n"), "bad-header", "twice");
  EXPECT_COMPLAINT(complaint("asc", "ncols 20000\nnrows 20000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2"), "truncated",
                   "400000000");
}

TEST(Png, HasItsPixels) {
  const std::string png = write_png({2, 1, {255, 0, 0, 255, 0, 0, 255, 0}});
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(png.substr(16, 10), std::string("\0\0\0\2\0\0\0\1\x08\x06", 10));  // 2 x 1, 8 bits, RGBA
  EXPECT_EQ(png, write_png({2, 1, {255, 0, 0, 255, 0, 0, 255, 0}}));
  EXPECT_THROW(write_png({2, 2, {0, 0, 0, 0}}), Error);
}

TEST(Formats, AreFoundByNameTypeAndContent) {
  EXPECT_EQ(format_named("nothing"), nullptr);
  EXPECT_EQ(format_of_file("a.tar.gz"), nullptr);
  EXPECT_EQ(format_of_file("A.TIFF"), format_named("tif"));
  EXPECT_EQ(format_of_media_type("application/octet-stream"), nullptr);
  EXPECT_EQ(format_of_media_type("Image/TIFF; application=geotiff"), format_named("tif"));
  EXPECT_EQ(format_of_bytes(tiff(3, 2, six)), format_named("tif"));
  EXPECT_EQ(format_of_bytes(grid), format_named("asc"));
  EXPECT_EQ(format_of_bytes("# hello\n\nv 1 2 3\n"), format_named("obj"));
  for (const char* text : {"", "# hello", "v x", "{}", "plywood", "\x89PNG"})
    EXPECT_EQ(format_of_bytes(text), nullptr) << text;
}

TEST(GeoTiff, ADefinitionThatNamesFilesIsRefusedBeforeItIsRead) {
  const std::string wkt =
      "ESRI PE String = PROJCS[\"x\",GEOGCS[\"x\",DATUM[\"x\",SPHEROID[\"x\",6378137,298]],PRIMEM[\"x\",0],"
      "UNIT[\"d\",0.0174]],PROJECTION[\"Transverse_Mercator\"],UNIT[\"m\",1],"
      "EXTENSION[\"PROJ4_GRIDS\",\"/etc/passwd\"]]|";
  const auto length = static_cast<std::uint16_t>(wkt.size());
  const std::string bytes = tiff(
      2, 2, {1, 2, 3, 4},
      {{34735, shorts({1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 32767, 3073, 34737, length, 0})}, {34737, text(wkt)}});
  EXPECT_EQ(complaint("tif", bytes).code, "bad-crs");
}

}  // namespace
}  // namespace terrane
