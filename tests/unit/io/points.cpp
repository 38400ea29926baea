// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>
#include <string>
#include <vector>

#include "unit/io/reading.hpp"

// Tables of points, and LAS.
namespace terrane {
namespace {

std::vector<Point> points(const char* format, std::string_view bytes, ReadOptions options = {.name = "input"}) {
  Context context;
  return std::get<PointCloud>(format_named(format)->read(bytes, options, context).surface).points;
}

const std::vector<Point> two = {{1, 2, 3}, {4.5, 5, -6}};

TEST(PointTable, AnySeparatorWillDo) {
  EXPECT_EQ(points("xyz", "1 2 3\n4.5\t5  -6\n"), two);
  EXPECT_EQ(points("xyz", "1,2,3\r\n4.5, 5, -6"), two);
  EXPECT_EQ(points("xyz",
                   "\xEF\xBB\xBF"
                   "1;2;3;stone\n\n# a comment\n4.5;5;-6;\n"),
            two);
}

TEST(PointTable, ColumnsAreNamedByTheFirstLineOrByLetters) {
  EXPECT_EQ(points("xyz", "name,Northing,Easting,Elevation\na,2,1,3\nb,5,4.5,-6\n"), two);
  EXPECT_EQ(points("xyz", "\"z\",\"x\",\"y\"\n3,1,2\n-6,4.5,5\n"), two);
  EXPECT_EQ(points("xyz", "17,2,1,3,oak\n18,5,4.5,-6,\n", {.name = "input", .columns = "PNEZD"}), two);
  EXPECT_EQ(points("xyz", "x,y,z\n1,2,3\n4.5,5,-6\n", {.name = "input", .columns = "XYZ"}), two);
}

TEST(PointTable, TheCrsMayStandInAComment) {
  Context context;
  EXPECT_EQ(format_named("xyz")->read("# crs: EPSG:25831\n1 2 3\n", {.name = "p"}, context).crs.id(), "EPSG:25831");
}

TEST(PointTable, WhatIsWrongIsNamedByItsLine) {
  EXPECT_EQ(complaint("xyz", "1 2 3\n1 2\n").code, "truncated");
  EXPECT_NE(std::string(complaint("xyz", "1 2 3\n1 2 x\n").what()).find("line 2"), std::string::npos);
  EXPECT_EQ(complaint("xyz", "1 2 nan\n").code, "bad-number");
  EXPECT_EQ(complaint("xyz", "1 2 1e400\n").code, "bad-number");
  EXPECT_EQ(complaint("xyz", "# nothing\n").code, "empty");
  EXPECT_EQ(complaint("xyz", "1 2 3\n", {.name = "p", .columns = "XYX"}).code, "bad-parameter");
  EXPECT_EQ(complaint("xyz", "1 2 3\n", {.name = "p", .max_vertices = 0}).code, "too-many-points");
}

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// A file of the given point format with points of the classes 2, 5 and 2, the last of them withheld.
std::string las(int format, const std::string& wkt = "") {
  const bool extended = format >= 6;
  const std::size_t header = extended ? 375 : 227, size = extended ? 30 : 20,
                    record = wkt.empty() ? 0 : 54 + wkt.size();
  std::string bytes(header + record + 3 * size, '\0');
  bytes.replace(0, 4, "LASF");
  put<std::uint8_t>(bytes, 24, 1), put<std::uint8_t>(bytes, 25, extended ? 4 : 2);
  put<std::uint16_t>(bytes, 94, static_cast<std::uint16_t>(header));
  put<std::uint32_t>(bytes, 96, static_cast<std::uint32_t>(header + record));
  put<std::uint32_t>(bytes, 100, wkt.empty() ? 0 : 1);
  put<std::uint8_t>(bytes, 104, static_cast<std::uint8_t>(format));
  put<std::uint16_t>(bytes, 105, static_cast<std::uint16_t>(size));
  if (extended)
    put<std::uint64_t>(bytes, 247, 3);
  else
    put<std::uint32_t>(bytes, 107, 3);
  for (int k = 0; k < 3; ++k) put<double>(bytes, 131 + 8 * k, 0.5), put<double>(bytes, 155 + 8 * k, 100.0 * k);
  if (!wkt.empty()) {
    bytes.replace(header + 2, 15, "LASF_Projection");
    put<std::uint16_t>(bytes, header + 18, 2112);
    put<std::uint16_t>(bytes, header + 20, static_cast<std::uint16_t>(wkt.size()));
    bytes.replace(header + 54, wkt.size(), wkt);
  }
  const int classes[3] = {2, 5, 2};
  for (int i = 0; i < 3; ++i) {
    const std::size_t at = header + record + i * size;
    for (int k = 0; k < 3; ++k) put<std::int32_t>(bytes, at + 4 * k, i + 2 * k);
    if (extended) {
      put<std::uint8_t>(bytes, at + 15, i == 2 ? 4 : 0);
      put<std::uint8_t>(bytes, at + 16, static_cast<std::uint8_t>(classes[i]));
    } else {
      put<std::uint8_t>(bytes, at + 15, static_cast<std::uint8_t>(classes[i] | (i == 2 ? 128 : 0)));
    }
  }
  return bytes;
}

TEST(Las, PointsOfTheClassesAskedForAreReadButNotWithheldOnes) {
  for (const int format : {0, 6}) {
    EXPECT_EQ(points("las", las(format)), (std::vector<Point>{{0, 101, 202}, {0.5, 101.5, 202.5}}));
    EXPECT_EQ(points("las", las(format), {.name = "l", .classes = {5}}), (std::vector<Point>{{0.5, 101.5, 202.5}}));
    const Error none = complaint("las", las(format), {.name = "l", .classes = {9}});
    EXPECT_EQ(none.code, "no-points");
    EXPECT_NE(std::string(none.what()).find("2 (2), 5 (1)"), std::string::npos);
  }
}

TEST(Las, TheCrsIsReadFromItsRecord) {
  Context context;
  const std::string bytes = las(6, Crs::parse("EPSG:2193").wkt1());
  EXPECT_EQ(format_named("las")->read(bytes, {.name = "l"}, context).crs.id(), "EPSG:2193");
}

TEST(Las, WhatIsBrokenIsRefused) {
  const std::string whole = las(0);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(complaint("las", whole.substr(0, size)).code, "") << size;
  std::string bytes = whole;
  put<std::uint8_t>(bytes, 104, 128);
  EXPECT_EQ(complaint("las", bytes).code, "compressed");
  put<std::uint8_t>(bytes, 104, 11);
  EXPECT_EQ(complaint("las", bytes).code, "bad-type");
  bytes = whole;
  put<double>(bytes, 131, 0);
  EXPECT_EQ(complaint("las", bytes).code, "bad-number");
  bytes = whole;
  put<std::uint32_t>(bytes, 107, 4'000'000'000u);
  EXPECT_EQ(complaint("las", bytes).code, "truncated");
}

}  // namespace
}  // namespace terrane
