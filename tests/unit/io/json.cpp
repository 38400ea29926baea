// SPDX-License-Identifier: GPL-3.0-or-later
#include "unit/io/reading.hpp"

namespace terrane {
namespace {

std::string with(const std::string& vertices, const std::string& triangles) {
  return R"({"type":"TIN","crs":"EPSG:25831","vertices":[)" + vertices + R"(],"triangles":[)" + triangles + "]}";
}

const std::string three = "[0,0,1],[1,0,2],[0,1,3]";

TEST(Json, ReadsAnyOrderAndSkipsWhatItDoesNotKnow) {
  const Tin tin = read_tin("json",
                           "\xef\xbb\xbf \n{ \"triangles\" : [ [ 0 , 1 , 2 ] ] , \"x\" : "
                           "{\"a\":[1,-2.5e3,true,false,null,\"\\u00e9\\ud83d\\ude00\\n\"],\"b\":{}}, \"type\":\"TIN\","
                           "\"vertices\":[[0 ,\t0,1],\r\n[1e0,0,2],[0,1,3]]}\n ");
  EXPECT_EQ(tin.vertices.size(), 3u);
  EXPECT_EQ(tin.faces, (std::vector<Face>{{0, 1, 2}}));
}

TEST(Json, TakesACrsAsTextObjectOrNull) {
  Context context;
  EXPECT_EQ(read("json", with(three, "[0,1,2]"), context).crs.id(), "EPSG:25831");
  EXPECT_FALSE(read("json", R"({"type":"TIN","crs":null,"vertices":[],"triangles":[]})", context).crs.known());
  const std::string projjson =
      R"({"type":"GeographicCRS","name":"WGS 84","datum":{"type":"GeodeticReferenceFrame","name":"World Geodetic System 1984",
    "ellipsoid":{"name":"WGS 84","semi_major_axis":6378137,"inverse_flattening":298.257223563}},"coordinate_system":{"subtype":"ellipsoidal",
    "axis":[{"name":"Geodetic latitude","abbreviation":"Lat","direction":"north","unit":"degree"},{"name":"Geodetic longitude","abbreviation":"Lon",
    "direction":"east","unit":"degree"}]},"id":{"authority":"EPSG","code":4326}})";
  EXPECT_EQ(read("json", R"({"type":"TIN","crs":)" + projjson + R"(,"vertices":[],"triangles":[]})", context).crs.id(),
            "EPSG:4326");
  EXPECT_TRUE(context.warnings.empty());
}

TEST(Json, BadNumbersAreNamedByVertex) {
  for (const char* number : {"NaN", "nan", "null", "Infinity", "-inf", "1e400", "\"1\"", "[1]", ""})
    EXPECT_COMPLAINT(complaint("json", with(three + ",[1,2," + number + "]", "[0,1,2]")), "bad-number", "vertex 3");
  EXPECT_COMPLAINT(complaint("json", with("[0,0]", "")), "bad-number", "vertex 0");
  EXPECT_COMPLAINT(complaint("json", with("[0,0,0,0]", "")), "bad-number", "vertex 0");
}

TEST(Json, BadIndicesAreNamedByTriangle) {
  for (const char* index : {"3", "-1", "2147483648", "99999999999999999999"})
    EXPECT_COMPLAINT(complaint("json", with(three, "[0,1,2],[0,1," + std::string(index) + "]")), "index-out-of-range",
                     "triangle 1");
  for (const char* index : {"1.5", "1e0", "null", "NaN", "\"1\"", ""})
    EXPECT_COMPLAINT(complaint("json", with(three, "[0,1,2],[0,1," + std::string(index) + "]")), "bad-face",
                     "triangle 1");
  EXPECT_COMPLAINT(complaint("json", with(three, "[0,1]")), "bad-face", "triangle 0");
  EXPECT_COMPLAINT(complaint("json", with(three, "[0,1,2,0]")), "bad-face", "triangle 0");
}

TEST(Json, OtherDocumentsAreRefused) {
  for (const char* text :
       {"{}", R"({"type":"FeatureCollection","features":[]})", R"({"type":"TIN"})", R"({"type":"TIN","vertices":[]})"})
    EXPECT_COMPLAINT(complaint("json", text), "not-terrane-json", "");
  for (const char* text : {"", "[]", "x", "{\"a\" 1}", "{a:1}", "{\"a\":01x}", "{\"a\":\"\\q\"}", "{\"a\":\"\\ud800\"}",
                           "{\"a\":\"\n\"}", "{\"a\":1,}", "{\"type\":\"TIN\",\"type\":\"TIN\"}", "{\"a\":tru}"})
    EXPECT_COMPLAINT(complaint("json", text), "bad-json", "byte");
  EXPECT_COMPLAINT(complaint("json", with(three, "[0,1,2]") + "x"), "bad-json", "after the closing brace");
}

TEST(Json, DepthIsLimited) {
  const auto nested = [](std::size_t depth) {
    return R"({"deep":)" + std::string(depth, '[') + std::string(depth, ']') +
           R"(,"type":"TIN","vertices":[],"triangles":[]})";
  };
  EXPECT_EQ(read_tin("json", nested(60)), Tin{});
  EXPECT_COMPLAINT(complaint("json", nested(70)), "bad-json", "64 levels");
  EXPECT_COMPLAINT(complaint("json", "{\"a\":" + std::string(1'000'000, '[')), "bad-json", "64 levels");
}

}  // namespace
}  // namespace terrane
