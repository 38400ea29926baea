// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/grid.hpp"

#include <cmath>

#include "core/plan_grid.hpp"
#include "core/surface.hpp"

namespace terrane {

double grid_step(const Length& asked, const Crs& crs) {
  if (!crs.known()) return asked.in(1);
  if (!crs.geographic()) return asked.in(crs.metres_per_length_unit());
  constexpr double metres_per_degree = 111694;  // at the poles, where a degree of latitude is longest
  const double longest = asked.in(1) / metres_per_degree;
  if (!(longest > 0)) return 0;
  const double power = std::floor(std::log10(longest));
  double step = 0;
  for (const double digit : {1.0, 2.0, 5.0, 10.0}) {
    const double candidate = power < 0 ? digit / std::pow(10, -power) : digit * std::pow(10, power);
    if (candidate <= longest) step = candidate;
  }
  return step;
}

bool wants_grid(const Plan& plan, const Crs& crs) {
  const auto asked = plan.parameters.find("grid");
  return asked != plan.parameters.end() && grid_step(Length::of(*asked), crs) > 0;
}

bool put_on_grid(Outcome& outcome, const Plan& plan, const Crs& crs, Context& context) {
  Tin* tin = std::get_if<Tin>(&outcome.result);
  if (!tin || !wants_grid(plan, crs)) return false;
  const double step = grid_step(Length::of(plan.parameters.at("grid")), crs);
  OnGrid made = put_on_grid(*tin, PlanGrid(step), context);
  const RoundingReport& r = made.rounding;
  outcome.certificate["grid"] = {
      {"step", step},     {"max_move", r.max_move}, {"max_spill", r.max_spill},   {"merges", r.merges},
      {"flips", r.flips}, {"kinetic", r.kinetic},   {"area_lost", made.area_lost}};
  RoundingReport sum = outcome.rounding.value_or(RoundingReport{});
  accumulate(sum, r);
  outcome.rounding = sum;
  *tin = std::move(made.tin);
  return true;
}

}  // namespace terrane
