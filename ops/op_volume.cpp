// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/error.hpp"
#include "core/toe.hpp"
#include "core/volume.hpp"
#include "ops/inputs.hpp"
#include "ops/measure.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"
#include "ops/volume_report.hpp"

namespace terrane {
namespace {

struct VolumeParameters {
  Length tolerance;
  std::vector<double> levels;
  double cut_factor = 1, fill_factor = 1;
  bool allow_empty = false;

  void visit(Fields& f) {
    f.length("tolerance", tolerance, {.minimum = 0}, "Differences in height up to this count as the same.");
    f.numbers("levels", levels,
           "Levels instead of a reference, a row each: a list (90,95,100) or from:to:step (90:110:5).");
    f.number("cut-factor", cut_factor, {.minimum = 0}, "",
             "What cut volumes are multiplied by in the adjusted net (bulking).");
    f.number("fill-factor", fill_factor, {.minimum = 0}, "",
             "What fill volumes are multiplied by in the adjusted net (shrinkage).");
    f.boolean("allow-empty", allow_empty, "Return zeros, with a warning, where the two do not overlap.");
  }
};

void check(const nlohmann::json& values, const std::vector<InputPart>& inputs) {
  const auto p = filled<VolumeParameters>(values);
  const bool reference =
      std::any_of(inputs.begin(), inputs.end(), [](const InputPart& i) { return i.slot == "reference"; });
  if (reference && !p.levels.empty())
    throw Error(ErrorKind::usage, "surplus-input", "'volume' takes either a reference or levels, not both");
  if (!reference && p.levels.empty())
    throw Error(ErrorKind::usage, "missing-input",
                "'volume' needs the input 'reference' (a TIN, a raster or a number), or the parameter levels");
}

Outcome run(std::vector<Surface>& inputs, const VolumeParameters& p, Context& context) {
  const Surface& surface = input(inputs, "surface");
  const Surface* reference = find_input(inputs, "reference");
  VolumeReport report(surface, {p.tolerance.in(surface.crs.known() ? surface.crs.metres_per_height_unit() : 1.0),
                                p.cut_factor, p.fill_factor});
  Surface toe;
  if (reference && !reference->word.empty()) {
    toe = {reference->slot, reference->word, "", toe_surface(surface.tin(), context), surface.crs};
    reference = &toe;
  }
  if (reference && !reference->level()) {
    warn_feet_beside_metres(surface, *reference, context);
    if (!report.add_reference(*reference, context)) {
      if (!p.allow_empty) refuse_no_overlap(surface, *reference);
      warn_no_overlap(surface, *reference, context);
    }
  } else {
    const auto levels = reference ? std::vector<double>{std::get<double>(reference->value)} : p.levels;
    for (double level : levels) report.add_level(level, context);
  }
  Outcome outcome;
  outcome.csv = report.csv();
  outcome.result = report.json();
  return outcome;
}

}  // namespace

Operation volume_operation() {
  return operation<VolumeParameters>(
      {.id = "volume",
       .title = "Volumes between two surfaces, or above and below a level",
       .description =
           "Cut, fill and net volume between a surface and a reference over their overlap, with plan and surface "
           "areas, on the grid and on the ellipsoid. Net = fill - cut; fill: the surface lies above.",
       .inputs = {{"surface", 1, 1, false, "The surface: a TIN or a raster."},
                  {"reference", 0, 1, true,
                   "What it is compared with: a TIN, a raster, a number (a level), or the word boundary, the TIN "
                   "through the surface's own border (for stockpiles).",
                   "boundary"}},
       .result = ResultKind::table,
       .check = check,
       .example = {.files = {"west.tif", "east.tif"}}},
      run);
}

}  // namespace terrane
