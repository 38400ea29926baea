// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vectors.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"
#include "io/sqlite_schema.hpp"

namespace terrane {
namespace {

Vectors read(std::string_view bytes) {
  Context context;
  return read_vectors(bytes, "region", context);
}

std::string refusal(std::string_view bytes) {
  try {
    read(bytes);
  } catch (const Error& error) {
    EXPECT_TRUE(error.kind == ErrorKind::input || error.kind == ErrorKind::limit);
    return error.what();
  }
  return "";
}

bool same(const Line& a, const Line& b) {
  const auto equal = [](const Point& p, const Point& q) {
    return p.x == q.x && p.y == q.y && (p.z == q.z || (std::isnan(p.z) && std::isnan(q.z)));
  };
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), equal);
}

const Line triangle = {{500000.1, 4500000.3, NAN}, {500010.7, 4500000.3, NAN}, {500000.1, 4500010.9, NAN}};
const Line rising = {{0.1, 0.2, 3.3}, {1.0 / 3, 2, 4}, {5, 1e-17, 1e7 / 3}};

Vectors mixed() {
  Vectors vectors;
  vectors.crs = Crs::parse("EPSG:25831");
  vectors.features.push_back({{{"name", "hole"}, {"level", 2.5}}, {}, {}, {{triangle, {}}}});
  vectors.features.push_back({{{"name", "line"}, {"level", 0.1}}, {}, {rising}, {}});
  vectors.features.push_back({{{"name", nullptr}, {"level", 7}}, {{1, 2, 3}}, {}, {}});
  return vectors;
}

TEST(Vectors, WrittenOutCoordinatesAreALineOrAPoint) {
  EXPECT_TRUE(same(read("-1,2;3,4.5;5,6;").lines().at(0), {{-1, 2, NAN}, {3, 4.5, NAN}, {5, 6, NAN}}));
  EXPECT_TRUE(same(read("1,2,3,4").lines().at(0), {{1, 2, NAN}, {3, 4, NAN}}));
  EXPECT_TRUE(same(read("1,2,3;4,5,6").lines().at(0), rising.size() ? Line{{1, 2, 3}, {4, 5, 6}} : Line{}));
  EXPECT_TRUE(same(read("1,2").points(), {{1, 2, NAN}}));
  EXPECT_FALSE(vector_format("1,2,3").has_value());
  EXPECT_FALSE(vector_format("nan,2").has_value());
  EXPECT_FALSE(vector_format("/etc/passwd").has_value());
}

TEST(Vectors, BlanksDoForCommas) {
  EXPECT_TRUE(same(read("1 2\n3\t4.5\n").lines().at(0), {{1, 2, NAN}, {3, 4.5, NAN}}));
  EXPECT_TRUE(same(read("1 2 3\n4  5 6").lines().at(0), {{1, 2, 3}, {4, 5, 6}}));
  EXPECT_TRUE(same(read("1 2, 3 4").lines().at(0), {{1, 2, NAN}, {3, 4, NAN}}));
  EXPECT_FALSE(vector_format("1-2").has_value());
  EXPECT_FALSE(vector_format("1;2\n3;4").has_value());  // what is apart here, numbers or places?
}

TEST(Vectors, ATableOfPlacesIsALine) {
  const Line two = {{1, 2, NAN}, {3, 4.5, NAN}};
  for (const char* text : {"x,y\n1,2\n3,4.5\n", "Y;X\r\n2;1\r\n4.5;3", "# a comment\n\neasting\tnorthing\n1\t2\n3\t4.5",
                           "\xEF\xBB\xBFLongitude Latitude\n 1 2\n3  4.5\n", "\"x\",\"y\"\n1,2\n3,4.5\n"})
    EXPECT_TRUE(same(read(text).lines().at(0), two)) << text;
  EXPECT_TRUE(same(read("X,Y,Z\n1,2,3\n4,5,\n").lines().at(0), {{1, 2, 3}, {4, 5, NAN}}));
  EXPECT_TRUE(same(read("x,y\n1,2\n").features.at(0).points, {{1, 2, NAN}}));
  EXPECT_TRUE(read("x,y\n").empty());
  EXPECT_TRUE(read("lat,lon\n1,2\n").lonlat);
  EXPECT_FALSE(read("x,lat\n1,2\n").lonlat);
  EXPECT_EQ(read("# crs: EPSG:25831\nx,y\n1,2\n").crs.id(), "EPSG:25831");
}

TEST(Vectors, FurtherColumnsOfATableAreProperties) {
  const Vectors v = read("id;Easting;note;Northing\n007;1;\"a;b \"\"c\"\"\";2\n8;3;;4.5;more\n");
  ASSERT_EQ(v.features.size(), 2u);
  EXPECT_TRUE(same(v.features[0].points, {{1, 2, NAN}}));
  EXPECT_EQ(v.features[0].properties, (nlohmann::json{{"id", "007"}, {"note", "a;b \"c\""}}));
  EXPECT_EQ(v.features[1].properties, (nlohmann::json{{"id", 8}, {"note", nullptr}}));
  EXPECT_NE(refusal("x,y,k\n1,2,3\n4\n").find("line 3"), std::string::npos);
  EXPECT_NE(refusal("x;y\n1,5;2\n").find("line 2"), std::string::npos);
  EXPECT_NE(refusal("x,y,z\n1,2,nan\n"), "");
  EXPECT_NE(refusal("name,size\n1,2\n"), "");
}

TEST(Vectors, TextThatIsNotUtf8IsTakenForLatin1) {
  const Vectors v = read("x,y,h\xF6he,h\xF8he\n1,2,\xE9t\xE9,3\n");
  EXPECT_EQ(v.features.at(0).properties, (nlohmann::json{{"höhe", "été"}, {"høhe", 3}}));
  EXPECT_EQ(read("x,y,höhe\n1,2,été\n").features.at(0).properties, (nlohmann::json{{"höhe", "été"}}));
}

TEST(Vectors, GeoJsonComesBackExactly) {
  const std::string bytes = write_vectors(mixed(), "geojson");
  const Vectors back = read(bytes);
  EXPECT_EQ(back.crs.id(), "EPSG:25831");
  ASSERT_EQ(back.features.size(), 3u);
  EXPECT_TRUE(same(back.features[0].polygons.at(0).outer, triangle));
  EXPECT_TRUE(same(back.features[1].lines.at(0), rising));
  EXPECT_EQ(back.features[1].properties, mixed().features[1].properties);
  EXPECT_EQ(write_vectors(back, "geojson"), bytes);
}

TEST(Vectors, GeoJsonOfEveryKindIsRead) {
  const Vectors v = read(R"({"type":"GeometryCollection","geometries":[
    {"type":"MultiPoint","coordinates":[[1,2],[3,4]]},
    {"type":"MultiLineString","coordinates":[[[0,0],[1,1]],[[2,2],[3,3,9]]]},
    {"type":"MultiPolygon","coordinates":[[[[0,0],[4,0],[4,4],[0,0]],[[1,0.5],[2,0.5],[2,1],[1,0.5]]]]}]})");
  ASSERT_EQ(v.features.size(), 1u);
  EXPECT_EQ(v.features[0].points.size(), 2u);
  EXPECT_EQ(v.features[0].lines.size(), 2u);
  ASSERT_EQ(v.polygons().size(), 1u);
  EXPECT_EQ(v.polygons()[0].holes.size(), 1u);
  EXPECT_EQ(v.lines().size(), 4u);
  EXPECT_TRUE(v.geojson && v.lonlat);
  EXPECT_FALSE(v.crs.known());
}

TEST(Vectors, ClosedLinesArePolygonsWherePolygonsAreWanted) {
  EXPECT_EQ(read("LINESTRING(0 0,1 0,1 1,0 0)").polygons().size(), 1u);
  EXPECT_EQ(read("LINESTRING(0 0,1 0,1 1)").polygons().size(), 0u);
}

TEST(Vectors, WktOfEveryKindIsRead) {
  EXPECT_TRUE(same(read(" polygon ((0 0, 4 0, 4 4, 0 0),(1 0.5, 2 0.5, 2 1, 1 0.5)) ").polygons().at(0).holes.at(0),
                   {{1, 0.5, NAN}, {2, 0.5, NAN}, {2, 1, NAN}}));
  EXPECT_TRUE(same(read("LINESTRING Z (0.1 0.2 3.3, 1 2 3)").lines().at(0), {{0.1, 0.2, 3.3}, {1, 2, 3}}));
  EXPECT_GT(read("CURVEPOLYGON(CIRCULARSTRING(0 0, 2 0, 2 2, 0 2, 0 0))").polygons().at(0).outer.size(), 20u);
  EXPECT_EQ(read("MULTIPOINT((1 2),(3 4))").points().size(), 2u);
}

TEST(Vectors, AGeoPackageComesBackExactly) {
  const std::string bytes = write_vectors(mixed(), "gpkg");
  EXPECT_EQ(vector_format(bytes), "gpkg");
  const Vectors back = read(bytes);
  EXPECT_EQ(back.crs.id(), "EPSG:25831");
  ASSERT_EQ(back.features.size(), 3u);
  EXPECT_TRUE(same(back.lines().at(0), rising));
  EXPECT_EQ(write_vectors(mixed(), "gpkg"), bytes) << "the same bytes every time";
}

TEST(Vectors, ADrawingHoldsLinesAtTheirLevel) {
  Vectors vectors;
  vectors.features.push_back({{{"level", 12.5}}, {}, {{{1, 2, NAN}, {3, 4, NAN}}}, {}});
  const std::string bytes = write_vectors(vectors, "dxf");
  EXPECT_EQ(vector_format(bytes), "dxf");
  const Vectors back = read(bytes);
  ASSERT_EQ(back.lines().size(), 1u);
  EXPECT_TRUE(same(back.lines()[0], {{1, 2, 12.5}, {3, 4, 12.5}}));
  EXPECT_EQ(write_vectors(vectors, "dxf"), bytes);
}

TEST(Vectors, ADrawingMayEndInACarriageReturn) {
  Vectors vectors;
  vectors.features.push_back({{{"level", 12.5}}, {}, {{{1, 2, NAN}, {3, 4, NAN}}}, {}});
  std::string bytes = write_vectors(vectors, "dxf");
  bytes.back() = '\r';
  EXPECT_EQ(read(bytes).lines().size(), 1u);
  EXPECT_NE(refusal("0\nSECTION\n\nO\r"), "");  // took for ever
}

TEST(Vectors, TextsHoldNoZeroBytes) {
  std::string drawing = "0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n8\n0\n90\n2\n70\n0\n10\n1";
  drawing += std::string(64, '\xff') + std::string(16, '\0') + "\n10\n3\n20\n4\n0\nENDSEC\n";
  EXPECT_NE(refusal(drawing).find("zero bytes"), std::string::npos);
  EXPECT_NE(refusal(std::string("x,y,k\n1,2,\0", 11)).find("zero bytes"), std::string::npos);
  EXPECT_NE(refusal(std::string("POINT (1 2)\0 POINT (3 4)", 25)).find("zero bytes"), std::string::npos);
}

TEST(Vectors, WhatIsBrokenIsRefusedWithItsPlace) {
  EXPECT_NE(refusal("{\"type\":\"Feature\""), "");
  EXPECT_NE(refusal(R"({"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1],[2,2]]]})").find("does not end"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"type":"FeatureCollection","features":[{"type":"Feature","geometry":null},
             {"type":"Feature","geometry":{"type":"Point","coordinates":[1,"x"]}}]})")
                .find("feature 1"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"type":"Point","coordinates":[1e400,2]})"), "");
  EXPECT_NE(refusal(R"({"type":"Topology","coordinates":[]})"), "");
  EXPECT_NE(refusal(R"({"type":"Point","coordinates":[1,2],"crs":{"type":"name","properties":{"name":"x"}}})"), "");
  EXPECT_NE(refusal("POLYGON((0 0, 1 0"), "");
  EXPECT_NE(refusal("POINT(1 2) POINT(3 4)"), "");
  EXPECT_NE(refusal("PK\3\4 no zip"), "");
  EXPECT_NE(refusal(std::string("SQLite format 3\0 no database", 28)), "");
  EXPECT_NE(refusal(std::string(200, '{')), "");
}

TEST(Vectors, AGeoPackageThatRunsAProgramWhenReadIsRefused) {
  const std::string plain = "CREATE TABLE gpkg_contents";
  for (const char* changed :
       {"CREATE VIEW  gpkg_contents", "create\tview  gpkg_contents", "CREATE/**/VIEW_gpkg_conten"}) {
    std::string gpkg = write_vectors(mixed(), "gpkg");
    const std::size_t at = gpkg.find(plain);
    ASSERT_NE(at, std::string::npos);
    gpkg.replace(at, plain.size(), changed);
    EXPECT_NE(refusal(gpkg).find("views"), std::string::npos) << changed;
  }
  std::string utf16 = write_vectors(mixed(), "gpkg");
  utf16[59] = 2;  // the encoding; words are spelled otherwise then
  EXPECT_NE(refusal(utf16).find("UTF-8"), std::string::npos);
  std::string loop = write_vectors(mixed(), "gpkg");
  ASSERT_EQ(loop[100], 5);                           // page 1 has pages below it
  loop.replace(108, 4, std::string("\0\0\0\1", 4));  // the last of them is itself
  EXPECT_NE(refusal(loop), "");

  EXPECT_FALSE(runs_when_read("CREATE TABLE \"as (\" (id INTEGER, b TEXT CHECK (CAST(b AS TEXT) <> ' AS ('))"));
  EXPECT_FALSE(runs_when_read("CREATE VIRTUAL TABLE \"rtree_v_geom\" USING rtree(id, minx, maxx, miny, maxy)"));
  EXPECT_FALSE(runs_when_read("CREATE TRIGGER t AFTER INSERT ON v BEGIN SELECT 1; END"));
  for (const char* sql :
       {"CREATE TEMP VIEW v AS SELECT 1", "CREATE TABLE t (a, b AS (a))", "CREATE TABLE t (b as/**/(1))",
        "CREATE TABLE t (b INT\xEF\xBB\xBFGENERATED ALWAYS AS (1))", "CREATE\xEF\xBB\xBFVIEW v AS SELECT 1",
        "CREATE -- TABLE\n VIEW v AS SELECT 1", "CREATE VIRTUAL TABLE v USING VirtualOGR('/etc')",
        "CREATE VIRTUAL TABLE v USING \"rtree\"(a)", "", "create"})
    EXPECT_TRUE(runs_when_read(sql)) << sql;
}

std::string from_hex(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2)
    bytes += static_cast<char>(std::stoi(std::string(text.substr(i, 2)), nullptr, 16));
  return bytes;
}

// a.shp and a.shx with one triangle; the second also an a.prj that holds PROJ4_GRIDS.
constexpr const char* zipped =
    "504b030414000000080000002100a8851afc39000000dc00000005000000612e736870636050e762c00ef25e303330b04239"
    "2b5ae41c8154c3a31301209a41a115c27f0ee513008c406c418c5920852c481a09d90be3c3e491d50300504b030414000000"
    "0800000021003c650a34290000006c00000005000000612e736878636050e762c00ecc5e303330b042392b5ae41c8154c3a3"
    "1301209a41a115c27f0ee5130046406c0100504b0102140314000000080000002100a8851afc39000000dc00000005000000"
    "0000000000000000800100000000612e736870504b01021403140000000800000021003c650a34290000006c000000050000"
    "00000000000000000080015c000000612e736878504b0506000000000200020066000000a80000000000";
constexpr const char* zipped_with_grid =
    "504b030414000000080000002100a8851afc39000000dc00000005000000612e736870636050e762c00ef25e303330b04239"
    "2b5ae41c8154c3a31301209a41a115c27f0ee513008c406c418c5920852c481a09d90be3c3e491d50300504b030414000000"
    "0800000021003c650a34290000006c00000005000000612e736878636050e762c00ecc5e303330b042392b5ae41c8154c3a3"
    "1301209a41a115c27f0ee5130046406c0100504b0304140000000800000021001e8b419c220000002000000005000000612e"
    "70726a738d0871f50bf6f4f78b560a08f2f73289770ff2740956d251aad04b2f4e528a0500504b0102140314000000080000"
    "002100a8851afc39000000dc000000050000000000000000000000800100000000612e736870504b01021403140000000800"
    "000021003c650a34290000006c00000005000000000000000000000080015c000000612e736878504b010214031400000008"
    "00000021001e8b419c22000000200000000500000000000000000000008001a8000000612e70726a504b0506000000000300"
    "030099000000ed0000000000";

TEST(Vectors, AZippedShapefileIsRead) {
  const std::vector<Polygon> polygons = read(from_hex(zipped)).polygons();
  ASSERT_EQ(polygons.size(), 1u);
  EXPECT_TRUE(same(polygons[0].outer, {{500010, 4400010, NAN}, {500040, 4400030, NAN}, {500040, 4400010, NAN}}));
}

TEST(Vectors, DefinitionsThatNameGridFilesAreRefusedBeforeTheyAreRead) {
  EXPECT_NE(refusal(from_hex(zipped_with_grid)).find("grid files"), std::string::npos);
  std::string gpkg = write_vectors(mixed(), "gpkg");
  const std::string name = "ETRS89 / UTM zone 31N", grid = "proj4_GRIDS UTM zone ";
  for (std::size_t at; (at = gpkg.find(name)) != std::string::npos;) gpkg.replace(at, name.size(), grid);
  EXPECT_NE(refusal(gpkg).find("grid files"), std::string::npos);
}

TEST(Vectors, ACollectionKeepsItsPoints) {
  EXPECT_EQ(read(R"({"type":"GeometryCollection","geometries":[{"type":"Point","coordinates":[1,2]},
                     {"type":"MultiPoint","coordinates":[[3,4],[5,6]]}]})")
                .points()
                .size(),
            3u);
}

TEST(Vectors, CutOffFilesAreRefusedOrPartlyRead) {
  for (const char* word : {"geojson", "gpkg", "dxf"}) {
    const std::string bytes = write_vectors(mixed(), word);
    for (std::size_t size = 0; size < bytes.size(); size += 97) refusal(bytes.substr(0, size));
  }
}

}  // namespace
}  // namespace terrane
