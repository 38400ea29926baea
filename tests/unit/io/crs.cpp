// SPDX-License-Identifier: GPL-3.0-or-later
#include <thread>

#include "unit/io/reading.hpp"

namespace terrane {
namespace {

TEST(Crs, IsUnknownByDefault) {
  const Crs crs;
  EXPECT_FALSE(crs.known());
  EXPECT_EQ(crs.id(), "");
  EXPECT_EQ(crs.wkt(), "");
  EXPECT_EQ(crs.vertical_datum(), "unknown");
  EXPECT_TRUE(crs.same_plan(Crs{}));
  EXPECT_FALSE(crs.same_plan(Crs::parse("EPSG:4326")));
}

TEST(Crs, IsGivenInManyWays) {
  for (const char* text : {"EPSG:25831", " epsg:25831\n", "http://www.opengis.net/def/crs/EPSG/0/25831",
                           "https://opengis.net/def/crs/EPSG/9.8.1/25831", "urn:ogc:def:crs:EPSG::25831"})
    EXPECT_EQ(Crs::parse(text).id(), "EPSG:25831") << text;
  const Crs crs = Crs::parse("EPSG:25831");
  EXPECT_EQ(Crs::parse(crs.wkt()).id(), "EPSG:25831");
  EXPECT_EQ(Crs::parse(crs.wkt1()).id(), "EPSG:25831");
  EXPECT_EQ(crs.wkt().find('\n'), std::string::npos);
  EXPECT_EQ(Crs::parse("OGC:CRS84").id(), "OGC:CRS84");
  EXPECT_EQ(Crs::parse("http://www.opengis.net/def/crs/OGC/1.3/CRS84").id(), "OGC:CRS84");
  EXPECT_EQ(Crs::parse("https://www.opengis.net/def/crs-compound?1=http://www.opengis.net/def/crs/EPSG/0/25831&2=http:/"
                       "/www.opengis.net/def/crs/EPSG/0/5773")
                .id(),
            "EPSG:25831+5773");
}

TEST(Crs, WktInLatin1SaysTheSameInUtf8) {
  std::string utf8 = Crs::parse("EPSG:25831").wkt1(), latin1 = utf8;
  const std::size_t name = utf8.find("UTM");
  utf8.replace(name, 1, "\xc3\x9c");
  latin1.replace(name, 1, "\xdc");
  const Crs crs = Crs::parse(latin1);
  EXPECT_EQ(crs.id(), "EPSG:25831");
  EXPECT_EQ(crs.wkt(), Crs::parse(utf8).wkt());
  const std::string unknown = latin1.substr(0, latin1.rfind(",AUTHORITY")) + "]";
  EXPECT_EQ(Crs::parse(Crs::parse(unknown).id()).id(), Crs::parse(unknown).id());
}

TEST(Crs, KnowsItsUnits) {
  const Crs feet = Crs::parse("EPSG:2263+6360");
  EXPECT_EQ(feet.length_unit(), "ftUS");
  EXPECT_EQ(feet.height_unit(), "ftUS");
  EXPECT_EQ(feet.metres_per_length_unit(), 1200.0 / 3937);
  const Crs mixed = Crs::parse("EPSG:2263+5703");
  EXPECT_EQ(mixed.height_unit(), "m");
  const Crs degrees = Crs::parse("EPSG:4326");
  EXPECT_TRUE(degrees.geographic());
  EXPECT_EQ(degrees.length_unit(), "degree");
  EXPECT_EQ(degrees.height_unit(), "m");
  const Crs local = Crs::parse("local:ft");
  EXPECT_TRUE(local.local());
  EXPECT_EQ(local.id(), "local:ft");
  EXPECT_EQ(local.wkt(), "");
  EXPECT_EQ(local.metres_per_height_unit(), 0.3048);
}

TEST(Crs, KnowsItsVerticalDatum) {
  EXPECT_EQ(Crs::parse("EPSG:25831").vertical_datum(), "unknown");
  EXPECT_EQ(Crs::parse("EPSG:25831+5773").vertical_datum(), Crs::parse("EPSG:4326+5773").vertical_datum());
  EXPECT_EQ(Crs::parse("EPSG:2263+6360").vertical_datum(), Crs::parse("EPSG:3358+5703").vertical_datum());
  EXPECT_NE(Crs::parse("EPSG:4979").vertical_datum(), "unknown");
  EXPECT_EQ(Crs::parse("EPSG:4979").horizontal().id(), "EPSG:4326");
  EXPECT_EQ(Crs::parse("EPSG:25831+5773").horizontal().id(), "EPSG:25831");
  EXPECT_EQ(Crs::parse(Crs::parse("EPSG:25831+5773").wkt()).id(), "EPSG:25831+5773");
}

TEST(Crs, ComparesPlans) {
  const auto same = [](const char* a, const char* b) { return Crs::parse(a).same_plan(Crs::parse(b)); };
  EXPECT_TRUE(same("EPSG:25831", "EPSG:25831+5773"));
  EXPECT_TRUE(same("EPSG:4326", "OGC:CRS84"));
  EXPECT_TRUE(same("EPSG:4326", "EPSG:4979"));
  EXPECT_FALSE(same("EPSG:4326", "EPSG:4258"));
  EXPECT_FALSE(same("EPSG:25831", "EPSG:25832"));
  EXPECT_FALSE(same("EPSG:25831", "EPSG:32631"));
  EXPECT_FALSE(same("EPSG:2263", "EPSG:32118"));  // feet and metres of one projection
  EXPECT_FALSE(same("local:m", "local:ft"));
  const std::string wkt =
      "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS "
      "84\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]";
  EXPECT_TRUE(same(wkt.c_str(), "EPSG:4326"));
}

TEST(Crs, ACodeWithOtherNumbersIsNotBelieved) {
  std::string wkt = Crs::parse("EPSG:25831").wkt();
  const std::size_t at = wkt.find("500000");
  ASSERT_NE(at, std::string::npos);
  wkt.replace(at, 6, "600000");
  EXPECT_NE(Crs::parse(wkt).id(), "EPSG:25831");
  EXPECT_FALSE(Crs::parse(wkt).same_plan(Crs::parse("EPSG:25831")));
}

TEST(Crs, CodesAreSpeltAsTheRegisterDoes) {
  std::string wkt = Crs::parse("EPSG:25831").wkt();
  const std::size_t at = wkt.rfind("EPSG");
  EXPECT_EQ(Crs::parse(wkt.replace(at, 4, "ePSG")).id(), "EPSG:25831");
  const Crs other = Crs::parse(wkt.replace(at, 4, "MINE"));
  EXPECT_EQ(Crs::parse(other.id()).id(), other.id());
}

TEST(Crs, WhatCannotBeUsedIsRefused) {
  for (const char* text :
       {"", " ", "nonsense", "25831", "EPSG:", "EPSG:0", "EPSG:99999999", "EPSG:4326 x", "EPSG:5773", "EPSG:4978",
        "EPSG:25831+5715", "EPSG:4807", "local:", "local:yd", "GEOGCS[", "GEOGCS[\"x\"]", "{}",
        "{\"type\":\"GeographicCRS\"}", "http://www.opengis.net/def/crs/EPSG/0"}) {
    try {
      Crs::parse(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind, ErrorKind::usage) << text;
      EXPECT_EQ(error.code, "bad-crs") << text;
    }
  }
}

TEST(Crs, TouchesNoFileAndNoNetwork) {
  const std::string geogcs =
      "GEOGCS[\"x\",DATUM[\"d\",SPHEROID[\"s\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0."
      "0174532925199433]";
  const std::string bound = "BOUNDCRS[SOURCECRS[" + Crs::parse("EPSG:4267").wkt() + "],TARGETCRS[" +
                            Crs::parse("EPSG:4326").wkt() +
                            "],ABRIDGEDTRANSFORMATION[\"n\",METHOD[\"NTv2\",ID[\"EPSG\",9615]],PARAMETERFILE["
                            "\"Latitude and longitude difference file\",\"/etc/passwd\"]]]";
  for (const std::string& text :
       {std::string("/etc/passwd"), std::string("@/etc/passwd"), std::string("file:///etc/passwd"),
        std::string("/vsicurl/http://127.0.0.1:1/x"), std::string("http://127.0.0.1:1/x.prj"),
        std::string("http://opengis.net.example.org/def/crs/EPSG/0/4326"),
        std::string("+proj=longlat +nadgrids=/etc/passwd"), std::string("+init=/etc/passwd:x"),
        geogcs + ",EXTENSION[\"PROJ4\",\"+proj=longlat +nadgrids=/etc/passwd\"]]",
        geogcs + ",EXTENSION[\"PROJ4_GRIDS\",\"/etc/passwd\"]]", bound, std::string(200'000, ' ') + "EPSG",
        "GEOGCS" + std::string(90'000, '['), "{\"a\":" + std::string(90'000, '[')})
    EXPECT_THROW(Crs::parse(text), Error) << text.substr(0, 80);
}

TEST(Crs, ADatumWithItsOwnShiftKeepsIt) {
  const Crs crs = Crs::parse(
      "GEOGCS[\"Local datum\",DATUM[\"Own\",SPHEROID[\"Bessel 1841\",6377397.155,299.1528128],"
      "TOWGS84[598.1,73.7,418.2,0.202,0.045,-2.455,6.7]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]");
  EXPECT_TRUE(crs.geographic());
  EXPECT_EQ(Crs::parse(crs.id()).id(), crs.id());
  EXPECT_TRUE(Crs::parse(crs.id()).same_plan(crs));
  std::vector<Point> points = {{10, 50, 1}};
  transform_points(points, crs, Crs::parse("EPSG:4326"));
  EXPECT_NEAR(points[0].x, 9.99881, 1e-4);  // about 80 m to the west, as DHDN is there
  EXPECT_NEAR(points[0].y, 49.99886, 1e-4);
}

TEST(Crs, WebMercatorAsItWasOnceWritten) { EXPECT_EQ(Crs::parse(Crs::parse("EPSG:3857").wkt1()).id(), "EPSG:3857"); }

TEST(Crs, IdMeansTheSameHoweverNamesWereSpelt) {
  std::string wkt = Crs::parse("EPSG:2263").wkt1();
  const std::size_t at = wkt.find("central_meridian");
  ASSERT_NE(at, std::string::npos);
  wkt.insert(at + 11, ".");
  const Crs crs = Crs::parse(wkt);
  EXPECT_EQ(Crs::parse(crs.id()).id(), crs.id());
  EXPECT_TRUE(Crs::parse(crs.id()).same_plan(crs));
}

TEST(Crs, IsSharedByThreads) {
  const Crs crs = Crs::parse("EPSG:25831+5773"), other = Crs::parse("EPSG:4326");
  std::vector<std::thread> threads;
  std::atomic<int> wrong = 0;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (int k = 0; k < 20; ++k) {
        std::vector<Point> points = {{457010, 4372383, 1}};
        transform_points(points, crs, other);
        if (std::fabs(points[0].x - 2.5) > 1e-4 || crs.same_plan(other) || crs.horizontal().id() != "EPSG:25831")
          ++wrong;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace terrane
