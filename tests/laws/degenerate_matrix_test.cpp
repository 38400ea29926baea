// SPDX-License-Identifier: GPL-3.0-or-later
// Thirty degenerate pairs, tests/data/degenerate, in eight positions each.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include "core/overlay.hpp"
#include "core/validate.hpp"
#include "core/volume.hpp"
#include "support/oracle.hpp"
#include "support/overlay_judge.hpp"
#include "support/polygons.hpp"

namespace terrane {
namespace {

const std::filesystem::path folder = std::filesystem::path(TERRANE_SOURCE_DIR) / "tests/data/degenerate";

std::vector<std::string> names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  return names;
}

Tin mesh(const nlohmann::json& json) {
  Tin tin;
  for (const auto& p : json.at("vertices")) tin.vertices.push_back({p.at(0), p.at(1), p.at(2)});
  for (const auto& f : json.at("faces")) tin.faces.push_back({f.at(0), f.at(1), f.at(2)});
  return tin;
}

struct Position {
  const char* name;
  bool exact;  // no coordinate is rounded
  bool swaps, mirrors;
  Point (*move)(const Point&);
};

const std::array<Position, 8> positions{{
    {"as_it_is", true, false, false, [](const Point& p) { return p; }},
    {"turned_by_90", true, false, false,
     [](const Point& p) {
       return Point{-p.y, p.x, p.z};
     }},
    {"turned_by_180", true, false, false,
     [](const Point& p) {
       return Point{-p.x, -p.y, p.z};
     }},
    {"turned_by_270", true, false, false,
     [](const Point& p) {
       return Point{p.y, -p.x, p.z};
     }},
    {"mirrored", true, false, true,
     [](const Point& p) {
       return Point{-p.x, p.y, p.z};
     }},
    {"transposed", true, false, true,
     [](const Point& p) {
       return Point{p.y, p.x, p.z};
     }},
    {"swapped", true, true, false, [](const Point& p) { return p; }},
    {"at_utm", false, false, false,
     [](const Point& p) {
       return Point{p.x + 500000, p.y + 4500000, p.z};
     }},
}};

Tin placed(Tin tin, const Position& position) {
  for (Point& p : tin.vertices) p = position.move(p);
  if (position.mirrors)
    for (Face& f : tin.faces) std::swap(f[1], f[2]);
  return tin;
}

class Degenerate : public ::testing::TestWithParam<std::tuple<std::string, int>> {};

TEST_P(Degenerate, IsRight) {
  const auto& [name, number] = GetParam();
  const Position& position = positions[number];
  std::ifstream file(folder / (name + ".json"));
  const nlohmann::json json = nlohmann::json::parse(file);
  Context context;
  Tin a = checked(placed(mesh(json.at("a")), position), "a", context);
  Tin b = checked(placed(mesh(json.at("b")), position), "b", context);
  ASSERT_TRUE(context.warnings.empty()) << context.warnings[0].message;
  if (position.swaps) std::swap(a, b);

  for (const double snap : {0.0, -1.0}) {
    const OverlayOptions options{.snap = snap};
    const Overlay overlaid = overlay(a, b, options, context);
    EXPECT_EQ(support::broken_promises(a, b, options, overlaid), "");
    const Tin seen = support::as_snapped(a, b, overlaid);
    const support::OracleCounts truth = support::oracle_counts(a, seen);
    EXPECT_EQ(static_cast<std::size_t>(overlaid.rounding.regions), truth.regions);
    if (position.exact && snap == 0) {
      EXPECT_EQ(json.at("expected").at("regions"), truth.regions);
    }

    // And GEOS, from the borders alone.
    Tin flat;
    double perimeter = 0;
    for (const Point2& p : overlaid.points) flat.vertices.push_back({p.x, p.y, 0});
    flat.faces.assign(overlaid.faces.begin(), overlaid.faces.end());
    for (const Tin* tin : {&a, &b}) {
      const Box box = bounds(*tin);
      perimeter += 2 * (box.xmax - box.xmin + box.ymax - box.ymin);
    }
    const auto of_a = support::Polygons::from_domain(a), of_b = support::Polygons::from_domain(b);
    const double play = 16 * std::max(1e-16, overlaid.rounding.max_move + overlaid.rounding.max_snap) * perimeter;
    const Inspection inspected = inspect(canonical(flat));
    const double area = plan_area(flat);
    EXPECT_NEAR(area, of_a.united_area(of_b), play + 1e-14 * area);
    EXPECT_NEAR(truth.overlap_area, of_a.shared_area(of_b), play + 1e-14 * area);
    if (position.exact && snap == 0) {
      EXPECT_EQ(json.at("expected").at("components"), inspected.components);
      EXPECT_EQ(json.at("expected").at("holes"), inspected.holes);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Matrix, Degenerate, ::testing::Combine(::testing::ValuesIn(names()), ::testing::Range(0, 8)),
                         [](const auto& info) {
                           std::string name = std::get<0>(info.param) + "_" + positions[std::get<1>(info.param)].name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace terrane
