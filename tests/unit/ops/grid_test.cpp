// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/grid.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "core/plan_grid.hpp"

namespace terrane {
namespace {

Length length(const char* text) { return *Length::read(text); }

TEST(grid, steps_are_in_the_units_of_the_crs) {
  EXPECT_EQ(grid_step(length("0.001"), Crs()), 0.001);
  EXPECT_EQ(grid_step(length("0.001"), Crs::parse("EPSG:25831")), 0.001);
  EXPECT_DOUBLE_EQ(grid_step(length("1 ft"), Crs::parse("EPSG:25831")), 0.3048);
  EXPECT_EQ(grid_step(length("0"), Crs::parse("EPSG:4326")), 0);
}

TEST(grid, in_degrees_the_step_is_short_and_nowhere_longer_on_the_ground) {
  const Crs degrees = Crs::parse("EPSG:4326");
  EXPECT_EQ(grid_step(length("0.001"), degrees), 5e-9);
  EXPECT_EQ(grid_step(length("1"), degrees), 5e-6);
  EXPECT_EQ(grid_step(length("0.2 m"), degrees), 1e-6);
  EXPECT_EQ(grid_step(length("300000"), degrees), 2);
}

Outcome plane() {
  Outcome outcome;
  outcome.result = Tin{{{0.1234, 0, 1}, {10.0001, 0, 2}, {0, 9.9996, 3}}, {{0, 1, 2}}};
  outcome.rounding = RoundingReport{.max_move = 1e-9, .flips = 2};
  return outcome;
}

TEST(grid, the_report_says_what_was_done) {
  Context context;
  Plan plan;
  Outcome outcome = plane();
  plan.parameters = {{"grid", 0.0}};
  EXPECT_FALSE(put_on_grid(outcome, plan, Crs(), context));
  EXPECT_FALSE(outcome.certificate.contains("grid"));
  plan.parameters = {{"grid", 0.001}};
  ASSERT_TRUE(put_on_grid(outcome, plan, Crs(), context));
  const auto& said = outcome.certificate.at("grid");
  EXPECT_EQ(said.at("step"), 0.001);
  EXPECT_NEAR(said.at("max_move").get<double>(), 4e-4, 1e-12);
  EXPECT_NEAR(said.at("area_lost").get<double>(), (9.8767 * 9.9996 - 9.877 * 10) / 2, 1e-9);
  EXPECT_NEAR(outcome.rounding->max_move, 4e-4, 1e-12);
  EXPECT_EQ(outcome.rounding->flips, 2);
  for (const Point& p : std::get<Tin>(outcome.result).vertices)
    EXPECT_EQ(PlanGrid(0.001).nearest(terrane::plan(p)), terrane::plan(p));
}

TEST(grid, a_grid_that_leaves_nothing_is_refused) {
  Context context;
  Plan plan;
  Outcome outcome = plane();
  plan.parameters = {{"grid", "1000ft"}};
  try {
    put_on_grid(outcome, plan, Crs(), context);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::input);
    EXPECT_NE(std::string(error.what()).find("304.8"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace terrane
