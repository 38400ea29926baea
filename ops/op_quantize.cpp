// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/level_cuts.hpp"
#include "core/volume.hpp"
#include "ops/binary.hpp"
#include "ops/idle_parameters.hpp"
#include "ops/inputs.hpp"
#include "ops/operations.hpp"

namespace terrane {
namespace {

struct QuantizeParameters {
  std::optional<Length> interval;
  Length base;
  std::vector<double> levels;

  void visit(Fields& f) {
    f.length("interval", interval, {.minimum = 0}, "The height of a step; either this or levels is needed.");
    f.length("base", base, {}, "A height that steps are counted from, up and down.");
    f.numbers("levels", levels, "The heights of the terraces instead: a list (90,95,100) or from:to:step (90:110:5).");
  }
};

void check(const nlohmann::json& values, const std::vector<InputPart>&) {
  const auto p = filled<QuantizeParameters>(values);
  if (p.interval.has_value() == !p.levels.empty())
    throw Error(ErrorKind::usage, p.interval ? "surplus-parameter" : "missing-parameter",
                "'quantize' takes either interval (with base) or levels" +
                    std::string(p.interval ? ", not both" : ": interval=10, or levels=90,95,100"));
  if (!p.interval) refuse_idle<QuantizeParameters>(values, {"base"}, "interval");
  if (p.interval && !(p.interval->value > 0))
    throw Error(ErrorKind::usage, "bad-parameter", "parameter 'interval' is 0; it takes a length above 0");
}

/// The heights of all terraces, from the lowest one up.
std::vector<double> terraces(const QuantizeParameters& p, const Surface& surface) {
  std::vector<double> heights;
  if (!p.interval) {
    heights = p.levels;
    std::sort(heights.begin(), heights.end());
    heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
    return heights;
  }
  const double unit = surface.crs.known() ? surface.crs.metres_per_height_unit() : 1.0;
  const double interval = p.interval->in(unit), base = p.base.in(unit);
  double low = INFINITY, high = -INFINITY;
  for (const Point& v : surface.tin().vertices) low = std::min(low, v.z), high = std::max(high, v.z);
  const double first = std::floor((low - base) / interval) - 1, last = std::floor((high - base) / interval) + 1;
  constexpr double most = 1e6;
  if (!(last - first <= most && std::fabs(first) < 1e15 && std::fabs(last) < 1e15))
    throw Error(ErrorKind::input, "too-many-levels",
                "the heights of '" + surface.name + "', " + nlohmann::json(low).dump() + " to " +
                    nlohmann::json(high).dump() + ", hold more than a million steps of " +
                    nlohmann::json(interval).dump() + "; use a larger interval");
  for (double k = first; k <= last; ++k) heights.push_back(base + k * interval);
  // The lowest terrace is the one that the lowest vertex is on.
  const auto above = std::upper_bound(heights.begin(), heights.end(), low);
  heights.erase(heights.begin(), above == heights.begin() ? above : above - 1);
  while (!heights.empty() && std::isinf(heights.back())) heights.pop_back();  // no vertex is that high
  if (heights.empty() || std::isinf(heights.front()))
    throw Error(
        ErrorKind::input, "too-high",
        "a terrace of '" + surface.name + "' would lie lower than numbers reach; use a smaller interval or base");
  return heights;
}

HeightFold terrace_height(std::vector<double> heights, double play) {
  return [heights = std::move(heights),
          play](const std::vector<std::optional<HeightRange>>& z) -> std::optional<HeightRange> {
    if (!z[0]) return {};
    const auto floor_of = [&](double height) {
      const auto above = std::upper_bound(heights.begin(), heights.end(), height);
      return above == heights.begin() ? heights.front() : *(above - 1);
    };
    const auto near = [&](double height) { return play + 1e-12 * std::max(1.0, std::fabs(height)); };
    return HeightRange{floor_of(z[0]->low - near(z[0]->low)), floor_of(z[0]->high + near(z[0]->high))};
  };
}

Outcome run(std::vector<Surface>& inputs, const QuantizeParameters& p, Context& context) {
  const Surface& surface = input(inputs, "surface");
  const std::vector<double> heights = terraces(p, surface);
  // Below the first level is the first terrace, too: nothing is cut there.
  const LevelZones zones = level_zones(surface.tin(), std::span<const double>(heights).subspan(1), context);
  Assembled steps = lifted(zones.mesh, heights, context);

  Outcome outcome;
  outcome.certificate["flat_at_levels"] = flat_areas(surface.tin(), heights, surface.crs, context);
  outcome.expected_height = terrace_height(heights, zones.height_play);
  outcome.expected_area = plan_area(surface.tin(), context);
  outcome.rounding = zones.rounding;
  accumulate(*outcome.rounding, steps.rounding);
  outcome.result = std::move(steps.tin);
  return outcome;
}

}  // namespace

Operation quantize() {
  return operation<QuantizeParameters>(
      {.id = "quantize",
       .title = "Cut a surface into terraces",
       .description =
           "Terraces joined by walls: every place is lowered to the level at or below it, {L[i] <= z < L[i + 1]} to "
           "L[i]; what lies below the first of given levels is raised to it. Faces are cut exactly at the levels.",
       .inputs = {{"surface", 1, 1, false, "The surface: a TIN or a raster."}},
       .check = check,
       .example = {.parameters = {{"interval", "5"}}}},
      run);
}

}  // namespace terrane
