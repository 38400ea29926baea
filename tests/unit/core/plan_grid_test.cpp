// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/plan_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/arithmetic.hpp"
#include "core/error.hpp"
#include "core/validate.hpp"
#include "core/volume.hpp"
#include "support/checks.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using namespace support;

double read(const char* text) { return std::strtod(text, nullptr); }

TEST(plan_grid, multiples_are_the_doubles_that_print_short) {
  EXPECT_EQ(PlanGrid(0.001).nearest(4500000.12345), read("4500000.123"));
  EXPECT_EQ(PlanGrid(0.001).nearest(-0.0004), 0);
  EXPECT_FALSE(std::signbit(PlanGrid(0.001).nearest(-0.0004)));
  EXPECT_EQ(PlanGrid(0.3).nearest(1.0), read("0.9"));
  EXPECT_EQ(PlanGrid(2.5).nearest(499999.0), 500000);
  EXPECT_EQ(PlanGrid(5e-9).nearest(7.1234567891), read("7.12345679"));
  EXPECT_EQ(PlanGrid(1e-12).nearest(4500000.1), 4500000.1) << "finer than doubles: nothing to round";
  std::mt19937_64 random(1);
  for (const double step : {0.001, 0.01, 0.3, 0.3048, 1.0 / 3, 2.5, 10.0, 1e4})
    for (int i = 0; i < 1000; ++i) {
      const double x = (static_cast<double>(random() >> 11) * 0x1p-53 - 0.5) * 2e7;
      const double at = PlanGrid(step).nearest(x);
      EXPECT_LE(std::fabs(at - x), step / 2 * (1 + 1e-6));
      EXPECT_EQ(PlanGrid(step).nearest(at), at);
    }
}

void expect_on_grid(const Tin& tin, double step) {
  const PlanGrid grid(step);
  Context context;
  const OnGrid made = put_on_grid(tin, grid, context);
  for (const Point& p : made.tin.vertices) ASSERT_EQ(grid.nearest(plan(p)), plan(p));
  EXPECT_EQ(wrong_with(made.tin), "");
  for (const Defect& d : find_defects(made.tin)) ADD_FAILURE() << d.element << ": " << d.message;
  EXPECT_LE(made.rounding.max_move, step * std::sqrt(0.5) * (1 + 1e-9));
  EXPECT_LE(made.rounding.max_spill, 3 * made.rounding.max_move);
  const double lost = plan_area(tin) - plan_area(made.tin);
  EXPECT_NEAR(made.area_lost, lost, 1e-9 * plan_area(tin));
  EXPECT_EQ(put_on_grid(made.tin, grid, context).tin, made.tin) << "what is on the grid stays";
  EXPECT_EQ(put_on_grid(canonical(shuffled(tin, 3)), grid, context).tin, made.tin) << "whatever the order";
  const auto heights = [](const Tin& t) {
    std::vector<double> all;
    for (const Point& p : t.vertices) all.push_back(p.z);
    std::sort(all.begin(), all.end());
    return all;
  };
  const std::vector<double> before = heights(tin), after = heights(made.tin);
  EXPECT_TRUE(std::includes(before.begin(), before.end(), after.begin(), after.end())) << "heights travel";
}

class NastyGrid : public ::testing::TestWithParam<std::string> {};

/// Sums of the pairs that broke overlays, walls and holes included, on grids finer and coarser than their faces.
TEST_P(NastyGrid, is_valid_and_on_the_grid) {
  for (const bool utm : {false, true}) {
    const Pair pair = nasty_pair(GetParam(), utm, 200);
    Context context;
    const Tin tin = combine(pair.a, pair.b, 1, Outside::keep, {Seam::wall, 0}, context).tin;
    for (const double step : {1e-3, 0.3, 10.0, 100.0, 1000.0}) {
      SCOPED_TRACE(testing::Message() << (utm ? "utm " : "") << step);
      expect_on_grid(tin, step);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(plan_grid, NastyGrid, ::testing::ValuesIn(nasty_pairs()), [](const auto& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(plan_grid, small_lattices_with_holes_and_walls_at_random) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 300; ++round) {
    std::string picture;
    for (int row = 0; row < 5; ++row) {
      for (int i = 0; i < 6; ++i) picture += random() % 6 == 0 ? '.' : static_cast<char>('0' + random() % 4);
      picture += '\n';
    }
    const Tin tin = drawn(picture, 1, {0.25, 0.5});
    if (tin.faces.empty() || !find_defects(tin).empty()) continue;
    Context context;
    const Tin other = shifted(tin, 0.37, 0.21, 0.5);
    const Tin sum = combine(tin, canonical(other), 1, Outside::keep, {Seam::wall, 0}, context).tin;
    SCOPED_TRACE(picture);
    for (const double step : {0.1, 0.4, 1.0, 1.5}) expect_on_grid(sum, step);
  }
}

TEST(plan_grid, vertices_that_meet_become_one_and_walls_stay) {
  const Tin low = drawn("1111\n1111\n1111"), high = shifted(drawn("5555\n5555\n5555"), 3.0004, 0);
  Context context;
  Tin both{low.vertices, low.faces};  // a slit of 0.4 mm between two tiles
  for (Face f : high.faces) {
    for (Index& v : f) v += static_cast<Index>(low.vertices.size());
    both.faces.push_back(f);
  }
  both.vertices.insert(both.vertices.end(), high.vertices.begin(), high.vertices.end());
  const OnGrid closed = put_on_grid(canonical(both), PlanGrid(0.001), context);
  EXPECT_EQ(inspect(closed.tin).components, 1u) << "the slit is narrower than the grid";
  EXPECT_EQ(closed.tin.vertices.size(), 2 * low.vertices.size() - 3);
  const OnGrid open = put_on_grid(canonical(both), PlanGrid(0.0001), context);
  EXPECT_EQ(inspect(open.tin).components, 2u);

  const Tin walled = combine(drawn("1111\n1111\n1111"), shifted(drawn("11\n11"), 0.5304, 0.52), 1, Outside::keep,
                             {Seam::wall, 0}, context)
                         .tin;
  const OnGrid kept = put_on_grid(walled, PlanGrid(0.001), context);
  EXPECT_EQ(inspect(kept.tin).walls, inspect(walled).walls);
  EXPECT_EQ(open_seams(kept.tin), "");
}

TEST(plan_grid, a_grid_wider_than_the_surface_is_refused_by_name) {
  Context context;
  for (const double step : {30.0, 1e6, 1e300}) try {
      put_on_grid(drawn("121\n131\n111", 2, {5, 5}), PlanGrid(step), context);
      FAIL() << step;
    } catch (const Error& error) {
      EXPECT_EQ(error.code, "grid");
      EXPECT_NE(std::string(error.what()).find("on a grid of "), std::string::npos);
    }
  EXPECT_TRUE(put_on_grid({}, PlanGrid(1), context).tin.faces.empty());
}

}  // namespace
}  // namespace terrane
