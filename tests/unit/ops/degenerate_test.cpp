// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "core/tin.hpp"
#include "ops/heights.hpp"
#include "unit/ops/requests.hpp"

using namespace terrane;

namespace {

std::string json(const Tin& tin) {
  nlohmann::json made = {{"type", "TIN"}, {"triangles", tin.faces}};
  for (const Point& p : tin.vertices) made["vertices"].push_back({p.x, p.y, p.z});
  return made.dump();
}

std::string grid(int columns, double west, double south) {
  std::string text = "ncols " + std::to_string(columns) + "\nnrows 3\nxllcenter " + std::to_string(west) +
                     "\nyllcenter " + std::to_string(south) + "\ncellsize 1\n";
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < columns; ++c) text += "3 ";
    text += "\n";
  }
  return text;
}

template <class Run>
std::string refusal(Run run) {
  try {
    run();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::input) << error.what();
    return error.code;
  }
  return "not refused";
}

double residual(const Response& r) { return std::fabs(r.report["area_balance"]["residual"].get<double>()); }

const Point a{0.1, 0.2, 1}, b{10.3, 3.7, 1}, c{2.9, 11.1, 1};
const Tin triangle{{a, b, c}, {{0, 1, 2}}};

/// The triangle again, five pieces to a side, whose ends lie on the triangle's sides but for rounding.
Tin fan() {
  Tin tin{{{4.43, 5, 3}}, {}};
  for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, a}})
    for (int k = 0; k < 5; ++k) tin.vertices.push_back({p.x + k * (q.x - p.x) / 5, p.y + k * (q.y - p.y) / 5, 1});
  for (Index k = 0; k < 15; ++k) tin.faces.push_back({0, k + 1, (k + 1) % 15 + 1});
  return tin;
}

}  // namespace

// What comes out goes in again: borders that rounding laid an ulp from those they were made of.
TEST(Degenerate, AreasBalanceWhereResultsMeetTheirOwnInputs) {
  const std::string one = json(triangle), two = json(fan());
  const Response merged = run("merge", {{"tiles", "one.json", "", one}, {"tiles", "two.json", "", two}});
  EXPECT_LT(residual(merged), 1e-10);
  std::vector<InputPart> parts;
  for (const std::string& tile : {one, two}) {
    const Response rest = run("subtract", {{"minuend", "m.json", "", merged.body}, {"subtrahend", "t.json", "", tile}});
    EXPECT_LT(residual(rest), 1e-10);
    EXPECT_NEAR(rest.report["area_balance"]["actual"].get<double>(), 50.69, 1e-9);
    parts.push_back({"tiles", "rest" + std::to_string(parts.size()) + ".json", "", rest.body});
  }
  EXPECT_LT(residual(run("merge", parts)), 1e-10);
}

TEST(Degenerate, TilesThatOnlyTouchAreSaidToTouch) {
  const Tin left{{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, {{0, 1, 2}}}, right{{{1, 0, 1}, {2, 0, 1}, {1, 1, 1}}, {{0, 1, 2}}};
  try {
    run("subtract", {{"minuend", "m.json", "", json(left)}, {"subtrahend", "t.json", "", json(right)}});
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, "no-overlap");
    EXPECT_NE(std::string(error.what()).find("only touch"), std::string::npos) << error.what();
  }
}

TEST(Degenerate, APoleBecomesOnePoint) {
  const Response r = run("merge", {{"tiles", "pole.asc", "", grid(5, 0, 88)}},
                         {{"assume-crs", "EPSG:4326"}, {"target-crs", "EPSG:3413"}});
  EXPECT_EQ(r.report["output"]["vertices"], 11);
  EXPECT_EQ(r.report["output"]["faces"], 12);
}

TEST(Degenerate, AGlobeGoesRoundOnce) {
  const InputPart east{"tiles", "east.asc", "", grid(361, 0, -1)},
      middle{"tiles", "middle.asc", "", grid(361, -180, -1)};
  EXPECT_EQ(refusal([&] { run("merge", {east, middle}, {{"assume-crs", "EPSG:4326"}}); }), "longitudes");
  EXPECT_NO_THROW(run("merge", {east}, {{"assume-crs", "EPSG:4326"}}));
}

TEST(Degenerate, HeightsThatOverflowAreRefused) {
  const std::string tin = json(triangle);
  EXPECT_EQ(refusal([&] { run("transform", {{"surface", "s.json", "", tin}}, {{"z-scale", "1e308"}}); }), "overflow");
  EXPECT_EQ(refusal([&] { run("add", {{"a", "s.json", "", tin}, {"b", "", "", "1e308"}}); }), "overflow");
  EXPECT_EQ(refusal([&] { run("subtract", {{"minuend", "s.json", "", tin}, {"subtrahend", "", "", "1e308"}}); }),
            "overflow");
}

TEST(Degenerate, ALevelMayHaveAUnit) {
  const Response r = run("add", {{"a", "s.json", "", json(triangle)}, {"b", "", "", "10ft"}});
  for (const auto body = nlohmann::json::parse(r.body); const auto& v : body["vertices"]) EXPECT_DOUBLE_EQ(v[2], 4.048);
  const Response feet = run("add", {{"a", "s.json", "", json(triangle)}, {"b", "", "", "0.3048 m"}},
                            {{"assume-crs", "local:ft"}});
  for (const auto body = nlohmann::json::parse(feet.body); const auto& v : body["vertices"]) EXPECT_DOUBLE_EQ(v[2], 2);
}

TEST(Degenerate, AHeightFieldWithoutAnExtentHasOneCell) {
  const Tin huge{{{-1e308, -1e308, 0}, {1e308, -1e308, 0}, {0, 1e308, 0}}, {{0, 1, 2}}};
  const Tin broken{{{0, 0, 0}, {INFINITY, 0, 0}, {0, NAN, 0}}, {{0, 1, 2}}};
  EXPECT_NO_THROW(HeightField(huge).at({0, 0}, 0));
  EXPECT_NO_THROW(HeightField(broken).at({1, 1}, 0));
}
