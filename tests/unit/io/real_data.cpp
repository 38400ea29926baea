// SPDX-License-Identifier: GPL-3.0-or-later
#include "unit/io/reading.hpp"

// Facts of SOURCES.md about the real files, where they are present.
namespace terrane {
namespace {

struct Expected {
  const char* file;
  int width, height;
  std::size_t samples;  // that are no voids
  double low, high;
  const char* crs;
};

/// Or the name of the test would hold the bytes of the struct, pointers included.
void PrintTo(const Expected& expected, std::ostream* out) { *out << expected.file; }

class RealRasters : public testing::TestWithParam<Expected> {};

TEST_P(RealRasters, AreWhatTheirSourceSays) {
  const Expected& expected = GetParam();
  const auto bytes = real_file(expected.file);
  if (!bytes) GTEST_SKIP() << expected.file << " is not here";
  Context context;
  const std::string name = std::string(expected.file).substr(std::string(expected.file).rfind('/') + 1);
  const Dataset data = format_of_file(name)->read(*bytes, {.name = name}, context);
  const Raster& raster = std::get<Raster>(data.surface);
  std::size_t count = 0;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (double z : raster.samples)
    if (!std::isnan(z)) {
      ++count;
      low = std::min(low, z);
      high = std::max(high, z);
    }
  EXPECT_EQ(raster.width, expected.width);
  EXPECT_EQ(raster.height, expected.height);
  EXPECT_EQ(count, expected.samples);
  EXPECT_NEAR(low, expected.low, 0.005);
  EXPECT_NEAR(high, expected.high, 0.005);
  EXPECT_EQ(data.crs.id(), expected.crs);
  EXPECT_TRUE(context.warnings.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Files, RealRasters,
    testing::Values(Expected{"balearic/balearic_30s.tif", 408, 186, 7628, -4, 1208, "EPSG:4326"},
                    Expected{"balearic/mallorca_30s.tif", 156, 108, 5537, -4, 1208, "EPSG:4326"},
                    Expected{"balearic/menorca_30s.tif", 78, 48, 1078, -2, 210, "EPSG:4326"},
                    Expected{"balearic/ibiza_30s.tif", 72, 48, 879, -2, 351, "EPSG:4326"},
                    Expected{"balearic/formentera_30s.tif", 42, 24, 134, -2, 176, "EPSG:4326"},
                    Expected{"balearic/mallorca_west_30s.tif", 96, 108, 3439, -4, 1208, "EPSG:4326"},
                    Expected{"balearic/mallorca_east_30s.tif", 78, 108, 3382, -1, 966, "EPSG:4326"},
                    Expected{"balearic/balearic_etopo5.tif", 55, 37, 2035, -2752, 438, "EPSG:4326"},
                    Expected{"tiles/N44W072.hgt", 1201, 1201, 1442401, 115, 1908, "EPSG:4326"},
                    Expected{"tiles/S33W071_w.tif", 401, 401, 160801, 613, 3770, "EPSG:4326"},
                    Expected{"tiles/S33W071_e.tif", 401, 401, 160801, 1077, 5402, "EPSG:4326"},
                    Expected{"tiles/frontrange_srtmgl3_w.tif", 144, 144, 20736, 2186, 3345, "EPSG:4326"},
                    Expected{"tiles/frontrange_srtmgl3_e.tif", 240, 144, 34560, 1943, 3286, "EPSG:4326"},
                    Expected{"epochs/fortbragg_dem_2004.tif", 450, 450, 202500, 89.26, 112.634, "EPSG:3358"},
                    Expected{"epochs/fortbragg_dem_2012.tif", 450, 450, 202500, 89.374, 112.707, "EPSG:3358"},
                    Expected{"epochs/fortbragg_dem_2016.tif", 450, 450, 202500, 89.344, 112.726, "EPSG:3358"}),
    [](const auto& info) {
      std::string name = info.param.file;
      for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
      return name;
    });

TEST(RealData, QuartersOfATileLieOnIt) {
  const auto whole_bytes = real_file("tiles/N44W072.hgt");
  if (!whole_bytes) GTEST_SKIP() << "tiles/N44W072.hgt is not here";
  const Raster whole = read_raster("hgt", *whole_bytes, "N44W072.hgt");
  for (const char* part : {"nw", "ne", "sw", "se"}) {
    const auto bytes = real_file(std::string("tiles/N44W072_") + part + ".tif");
    ASSERT_TRUE(bytes);
    const Raster quarter = read_raster("tif", *bytes);
    const int i0 = static_cast<int>(std::lround((quarter.x0 - whole.x0) / whole.dx)),
              j0 = static_cast<int>(std::lround((whole.y0 - quarter.y0) / whole.dy));
    EXPECT_NEAR(quarter.x0, whole.place(i0, j0).x, 1e-10);
    EXPECT_NEAR(quarter.y0, whole.place(i0, j0).y, 1e-10);
    for (int j = 0; j < quarter.height; ++j)
      for (int i = 0; i < quarter.width; ++i) ASSERT_EQ(quarter.at(i, j), whole.at(i0 + i, j0 + j));
  }
}

TEST(RealData, CellCentresMatchTheirProjectedTable) {
  const auto bytes = real_file("balearic/formentera_30s.tif"), table = real_file("balearic/formentera_30s_utm31.xyz");
  if (!bytes || !table) GTEST_SKIP() << "balearic/formentera_30s is not here";
  const Raster raster = read_raster("tif", *bytes);
  std::vector<Point> points;
  for (int j = 0; j < raster.height; ++j)
    for (int i = 0; i < raster.width; ++i)
      if (!std::isnan(raster.at(i, j))) points.push_back({raster.place(i, j).x, raster.place(i, j).y, raster.at(i, j)});
  transform_points(points, Crs::parse("EPSG:4326"), Crs::parse("EPSG:25831"));
  std::istringstream lines(*table);
  std::vector<Point> rows;
  for (Point p; lines >> p.x >> p.y >> p.z;) rows.push_back(p);
  ASSERT_EQ(rows.size(), points.size());
  for (const Point& row : rows) {
    double nearest = HUGE_VAL;
    for (const Point& p : points)
      if (p.z == row.z) nearest = std::min(nearest, std::hypot(p.x - row.x, p.y - row.y));
    EXPECT_LT(nearest, 0.01);
  }
}

TEST(RealData, APlyFromOutside) {
  const auto bytes = real_file("tin/ply/mdal_test_mesh.ply");
  if (!bytes) GTEST_SKIP() << "tin/ply/mdal_test_mesh.ply is not here";
  const Tin tin = read_tin("ply", *bytes);
  EXPECT_EQ(tin.vertices.size(), 38487u);
  EXPECT_EQ(tin.faces.size(), 76294u);
  EXPECT_EQ(tin.vertices[0], (Point{416155, 381556, 309.78}));
  Context context;
  for (const char* format : {"obj", "json", "ply"})
    expect_same_bits(read_tin(format, written(*format_named(format), tin, Crs::parse("local:m"), {}, context)), tin);
}

}  // namespace
}  // namespace terrane
