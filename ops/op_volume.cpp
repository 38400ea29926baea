// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/error.hpp"
#include "core/toe.hpp"
#include "core/volume.hpp"
#include "ops/inputs.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"
#include "ops/volume_regions.hpp"
#include "ops/volume_report.hpp"

namespace terrane {
namespace {

struct VolumeParameters {
  Length tolerance;
  std::vector<double> levels;
  std::optional<Vectors> region;
  std::string region_crs;
  double cut_factor = 1, fill_factor = 1;
  bool polygons = false, allow_empty = false;

  void visit(Fields& f) {
    f.length("tolerance", tolerance, {.minimum = 0}, "Differences in height up to this count as the same.");
    f.numbers("levels", levels,
              "Levels instead of a reference, a row each: a list (90,95,100) or from:to:step (90:110:5).");
    f.vectors("region", region,
              "Polygons to measure in, a row each, named by the property name, id or fid, else by their number. "
              "Regions may overlap, each is measured by itself; one that does not touch the surface has a row of "
              "zeros. With the reference boundary each part stands on the toe of its own outline, as a stockpile "
              "within a drawn outline does.");
    f.crs("region-crs", region_crs, "The CRS of the regions, where their bytes do not say it.");
    f.boolean("polygons", polygons,
              "Return the areas above, same and below as polygons instead, each connected area with its kind, volume, "
              "areas and largest difference, and its region and level where there are any; the report then holds the "
              "rows.");
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

/// The rows of one part of the surface, or of all of it: one against a reference, or one for each level.
std::vector<VolumeRow> rows_of(const Tin& surface, const Tin* reference, const std::vector<double>& levels,
                               const VolumeMeasure& measure, Context& context) {
  if (reference) return {measure.between(surface, *reference, context)};
  return measure.at_levels(surface, levels, context);
}

/// What the surface is measured against.
struct Against {
  const Surface* reference = nullptr;  // a TIN; null where levels are given, or the toe of each part
  bool toe = false;
  std::vector<double> levels;
};

/// A report of regions, in their order.
void add_regions(VolumeReport& report, const Surface& surface, const Against& against, const Vectors& vectors,
                 const VolumeMeasure& measure, Context& context) {
  const std::vector<VolumeRegion> regions = volume_regions(vectors);
  std::vector<std::vector<VolumeRow>> rows(regions.size());
  const Tin* reference = against.reference ? &against.reference->tin() : nullptr;
  for_each_part(surface, reference, regions, context, [&](const auto& alike, const VolumePart& part, Context& own) {
    Tin toe;
    if (against.toe && !part.surface.faces.empty()) toe = toe_surface(part.surface, own);
    const Tin* beneath = against.toe ? &toe : reference ? &part.reference : nullptr;
    const std::vector<VolumeRow> measured = rows_of(part.surface, beneath, against.levels, measure, own);
    for (const std::size_t i : alike) {
      rows[i] = measured;
      for (VolumeRow& row : rows[i]) row.region = regions[i].name;
    }
  });
  for (auto& of_region : rows)
    for (VolumeRow& row : of_region) report.add(std::move(row));
}

Against against_what(const Surface& surface, const Surface* reference, const VolumeParameters& p, Context& context) {
  Against against;
  if (!reference) {
    against.levels = p.levels;
  } else if (!reference->word.empty()) {
    against.toe = true;
  } else if (reference->level()) {
    against.levels = {std::get<double>(reference->value)};
  } else {
    warn_feet_beside_metres(surface, *reference, context);
    against.reference = reference;
  }
  return against;
}

std::string name_of(const Against& against, const Surface* reference) {
  if (against.levels.empty()) return reference->word.empty() ? reference->name : reference->word;
  return against.levels.size() == 1 ? nlohmann::json(against.levels[0]).dump() : "levels";
}

/// Some part of the surface was measured, but nothing of its reference was there.
bool missed(const VolumeReport& report) {
  bool any = false, overlap = false;
  for (const VolumeRow& row : report.rows()) {
    any = any || row.grid.surface_only_area_2d > 0 || row.grid.overlap_area_2d > 0;
    overlap = overlap || row.grid.overlap_area_2d > 0;
  }
  return any && !overlap;
}

Outcome run(std::vector<Surface>& inputs, const VolumeParameters& p, Context& context) {
  const Surface& surface = input(inputs, "surface");
  const Surface* reference = find_input(inputs, "reference");
  const VolumeOptions options = {p.tolerance.in(surface.crs.known() ? surface.crs.metres_per_height_unit() : 1.0),
                                 p.cut_factor, p.fill_factor, p.polygons};
  const Against against = against_what(surface, reference, p, context);
  const VolumeMeasure measure(surface.crs, options);
  VolumeReport report(surface, name_of(against, reference), !against.levels.empty(), options);
  if (p.region) {
    add_regions(report, surface, against, *p.region, measure, context);
  } else {
    Tin toe;
    if (against.toe) toe = toe_surface(surface.tin(), context);
    const Tin* beneath = against.toe ? &toe : against.reference ? &against.reference->tin() : nullptr;
    for (VolumeRow& row : rows_of(surface.tin(), beneath, against.levels, measure, context)) report.add(std::move(row));
  }
  if (against.reference && missed(report)) {
    if (!p.allow_empty) refuse_no_overlap(surface, *against.reference);
    warn_no_overlap(surface, *against.reference, context);
  }
  Outcome outcome;
  if (p.polygons) {
    outcome.certificate["volume"] = report.json();
    outcome.result = report.polygons();
    return outcome;
  }
  outcome.csv = [text = report.csv()] { return text; };
  outcome.result = report.json();
  return outcome;
}

}  // namespace

Operation volume_operation() {
  auto made = operation<VolumeParameters>(
      {.id = "volume",
       .title = "Volumes between two surfaces, or above and below a level",
       .description =
           "Cut, fill and net volume between a surface and a reference over their overlap, with plan and surface "
           "areas, on the grid and on the ellipsoid. Net = fill - cut; fill: the surface lies above. For all of it, in "
           "regions, at levels; as a report, or as the polygons of above, same and below.",
       .inputs = {{"surface", 1, 1, false, "The surface: a TIN or a raster."},
                  {"reference", 0, 1, true,
                   "What it is compared with: a TIN, a raster, a number (a level), or the word boundary, the TIN "
                   "through the surface's own border (for stockpiles).",
                   "boundary"}},
       .result = ResultKind::table,
       .check = check,
       .result_with =
           [](const nlohmann::json& values) {
             return values.value("polygons", false) ? ResultKind::vectors : ResultKind::table;
           },
       .example = {.files = {"west.tif", "east.tif"}}},
      run);
  for (const std::string& word : formats_of(ResultKind::vectors)) made.output_formats.push_back(word);
  return made;
}

}  // namespace terrane
