// SPDX-License-Identifier: GPL-3.0-or-later
#include "unit/io/reading.hpp"

// What every mesh format must do.
namespace terrane {
namespace {

class Meshes : public testing::TestWithParam<const char*> {
 protected:
  std::string written(const Tin& tin, const Crs& crs = {}, const WriteOptions& options = {}) {
    Context context;
    return terrane::written(*format_named(GetParam()), tin, crs, options, context);
  }
};

TEST_P(Meshes, ComeBackBitForBit) { expect_same_bits(read_tin(GetParam(), written(awkward_tin())), awkward_tin()); }

TEST_P(Meshes, AreWrittenTheSameTwice) {
  EXPECT_EQ(written(awkward_tin()), written(read_tin(GetParam(), written(awkward_tin()))));
}

TEST_P(Meshes, MayBeEmpty) { EXPECT_EQ(read_tin(GetParam(), written({})), Tin{}); }

TEST_P(Meshes, CarryTheirCrs) {
  const std::string wkt = Crs::parse("EPSG:2263").wkt();
  const std::string renamed = "PROJCRS[\"one \\ of ours\"" + wkt.substr(wkt.find(",BASEGEOGCRS"));
  const std::string own = renamed.substr(0, renamed.rfind(",ID[")) + "]";
  for (const std::string& text :
       {std::string("EPSG:25831"), std::string("EPSG:25831+5773"), std::string("local:ftUS"), own}) {
    const Crs crs = Crs::parse(text);
    Context context;
    const Dataset data = read(GetParam(), written(awkward_tin(), crs), context);
    EXPECT_EQ(data.crs.id(), crs.id()) << text;
    EXPECT_TRUE(context.warnings.empty());
  }
  Context context;
  EXPECT_FALSE(read(GetParam(), written(awkward_tin()), context).crs.known());
}

TEST_P(Meshes, AreRecognised) {
  const std::string bytes = written(awkward_tin(), Crs::parse("EPSG:25831"));
  EXPECT_EQ(format_of_bytes(std::string_view(bytes).substr(0, 400)), format_named(GetParam()));
  EXPECT_EQ(format_of_file("a.b/C" + format_named(GetParam())->extensions[0]), format_named(GetParam()));
  EXPECT_EQ(format_of_media_type(format_named(GetParam())->media_type + "; charset=utf-8"), format_named(GetParam()));
}

TEST_P(Meshes, CutAnywhereAreRefusedOrWhole) {
  const std::string bytes = written(awkward_tin(), Crs::parse("EPSG:25831"));
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    // All that may be missing unnoticed is the blank at the end of a text.
    if (length + 1 == bytes.size() && bytes.back() == '\n') continue;
    const Error error = complaint(GetParam(), std::string_view(bytes).substr(0, length));
    EXPECT_EQ(error.kind, ErrorKind::input) << length << " of " << bytes.size() << " bytes: " << error.what();
  }
}

TEST_P(Meshes, LargerThanAllowedAreRefused) {
  const Error error = complaint(GetParam(), written(awkward_tin()), {.name = "bad.file", .max_vertices = 5});
  EXPECT_EQ(error.kind, ErrorKind::limit);
}

TEST_P(Meshes, StopWhenNobodyWaits) {
  Tin strip;
  for (Index v = 0; v < 200'000; ++v) strip.vertices.push_back({v * 0.5, v % 2 * 1.0, 0});
  for (Index v = 0; v + 2 < 200'000; ++v) strip.faces.push_back({v, v + 1, v + 2});
  const std::string bytes = written(strip);
  Context context;
  context.cancelled = true;
  try {
    read(GetParam(), bytes, context);
    FAIL() << "read to the end";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::cancelled);
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, Meshes, testing::Values("obj", "json", "ply"),
                         [](const auto& info) { return info.param; });

TEST(Json, CarriesTheCertificate) {
  Context context;
  const std::string text = written(
      *format_named("json"), awkward_tin(), {}, {.certificate_json = R"({"type":"Certificate","a":[1,{"b":null}]})", .extra = {}}, context);
  EXPECT_NE(text.find(R"("certificate":{"type":"Certificate","a":[1,{"b":null}]}})"), std::string::npos);
  expect_same_bits(read_tin("json", text), awkward_tin());
}

TEST(Obj, CarriesFurtherCommentsOnOneLine) {
  Context context;
  const std::string text = written(
      *format_named("obj"), awkward_tin(), {}, {.certificate_json = "", .extra = {{"software", "terrane\nv 1 2 3"}}}, context);
  EXPECT_NE(text.find("# software: terrane v 1 2 3\n"), std::string::npos);
  expect_same_bits(read_tin("obj", text), awkward_tin());
}

}  // namespace
}  // namespace terrane
