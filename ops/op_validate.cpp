// SPDX-License-Identifier: GPL-3.0-or-later

#include "core/validate.hpp"
#include "ops/inputs.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"
#include "ops/repair.hpp"

namespace terrane {
namespace {

struct ValidateParameters {
  bool repair = false;

  void visit(Fields& f) {
    f.boolean("repair", repair,
              "Return the mended TIN, and say what was changed, instead of the list of what is wrong.");
  }
};

nlohmann::json defect_list(const Tin& tin, const Context& context) {
  nlohmann::json list = nlohmann::json::array();
  for (const Defect& d : find_defects(tin, 20, context))
    list.push_back({{"code", d.code}, {"element", d.element}, {"message", d.message}});
  return list;
}

nlohmann::json topology_json(const Inspection& seen) {
  return {{"inverted", seen.inverted},
          {"degenerate", seen.degenerate},
          {"t_junctions", seen.t_junctions},
          {"non_manifold_edges", seen.non_manifold_edges},
          {"overlaps", seen.overlaps}};
}

Outcome run(std::vector<Surface>& inputs, const ValidateParameters& p, Context& context) {
  Surface& surface = input(inputs, "surface");
  Tin tin = std::move(std::get<Tin>(surface.value));
  Outcome outcome;
  if (!p.repair) {
    const auto defects = defect_list(tin, context);
    const Inspection seen = inspect(tin, context);
    outcome.result = nlohmann::json{
        {"type", "ValidationReport"}, {"name", surface.name}, {"valid", defects.empty()},       {"defects", defects},
        {"vertices", seen.vertices},  {"faces", seen.faces},  {"topology", topology_json(seen)}};
    return outcome;
  }
  Repaired repaired = repair(std::move(tin), surface.name, context);
  outcome.certificate["repair"] = repaired.changes;
  outcome.result = std::move(repaired.tin);
  return outcome;
}

}  // namespace

Operation validate() {
  auto made = operation<ValidateParameters>(
      {.id = "validate",
       .title = "Check a surface, or mend it",
       .description =
           "What is wrong with a TIN, element by element; or, with repair, the mended TIN and what was changed.",
       .inputs = {{"surface", 1, 1, false, "The surface: a TIN or a raster."}},
       .result = ResultKind::report,
       .intake = {.check = false, .empty_allowed = true},
       .result_with =
           [](const nlohmann::json& values) {
             return values.value("repair", false) ? ResultKind::surface : ResultKind::report;
           },
       .example = {.parameters = {{"repair", "true"}}}},
      run);
  for (const std::string& word : formats_of(ResultKind::surface))
    if (word != "json") made.output_formats.push_back(word);
  return made;
}

}  // namespace terrane
