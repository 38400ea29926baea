// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/level_cuts.hpp"
#include "core/volume.hpp"
#include "ops/binary.hpp"
#include "ops/inputs.hpp"
#include "ops/operations.hpp"

namespace terrane {
namespace {

enum class TrueWhen { above, below };

struct ThresholdParameters {
  std::optional<Length> level;
  BinaryHeights heights;
  TrueWhen true_when = TrueWhen::above;

  void visit(Fields& f) {
    f.length("level", level, {}, "The height at which the surface is divided; needed.");
    heights.visit(f);
    f.choice("true-when", true_when, {{"above", TrueWhen::above}, {"below", TrueWhen::below}},
             "What is true: above, where z >= level; or below, where z < level. What lies exactly at the level is true "
             "in the first case and false in the second: each is the NOT of the other.");
  }
};

void check(const nlohmann::json& values, const std::vector<InputPart>&) {
  const auto p = filled<ThresholdParameters>(values);
  if (!p.level)
    throw Error(ErrorKind::usage, "missing-parameter", "'threshold' needs the parameter level, a height (level=12.5)");
  p.heights.check();
}

/// Both answers are right within the play around the level.
HeightFold binary_height(double level, double play, const BinaryHeights& heights, bool above) {
  return [=](const std::vector<std::optional<HeightRange>>& z) -> std::optional<HeightRange> {
    if (!z[0]) return {};
    const double near = play + 1e-12 * std::max(1.0, std::fabs(level));
    const double a = heights.of((z[0]->low - near >= level) == above),
                 b = heights.of((z[0]->high + near >= level) == above);
    return HeightRange{std::min(a, b), std::max(a, b)};
  };
}

Outcome run(std::vector<Surface>& inputs, const ThresholdParameters& p, Context& context) {
  const Surface& surface = input(inputs, "surface");
  const double level = p.level->in(surface.crs.known() ? surface.crs.metres_per_height_unit() : 1.0);
  const bool above = p.true_when == TrueWhen::above;
  const LevelZones zones = level_zones(surface.tin(), std::vector<double>{level}, context);
  Assembled binary = lifted(zones.mesh, std::vector<double>{p.heights.of(!above), p.heights.of(above)}, context);

  Outcome outcome;
  const nlohmann::json flat = flat_areas(surface.tin(), {level}, surface.crs, context);
  if (flat["faces"] != 0)
    context.warn({"flat-at-level", surface.name, "",
                  flat["faces"].dump() + " faces lie exactly at the level, with an area of " + flat["area_2d"].dump() +
                      "; they count as " + (above ? "true" : "false"),
                  "move the level a little where they should count as the other"});
  outcome.certificate["flat_at_level"] = flat;
  outcome.certificate["truth"] = truth_areas(binary.tin, p.heights, surface.crs, context);
  outcome.expected_height = binary_height(level, zones.height_play, p.heights, above);
  outcome.expected_area = plan_area(surface.tin(), context);
  outcome.rounding = zones.rounding;
  accumulate(*outcome.rounding, binary.rounding);
  outcome.result = std::move(binary.tin);
  return outcome;
}

}  // namespace

Operation threshold() {
  return operation<ThresholdParameters>(
      {.id = "threshold",
       .title = "Divide a surface at a level into true and false",
       .description =
           "A binary surface: level areas at z-true and z-false, joined by walls where the surface passes the level. "
           "Faces are cut exactly at the level; the areas are triangulated anew, with no more points than their "
           "borders need.",
       .inputs = {{"surface", 1, 1, false, "The surface: a TIN or a raster."}},
       .check = check,
       .example = {.parameters = {{"level", "110"}}}},
      run);
}

}  // namespace terrane
