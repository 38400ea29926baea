// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/box.hpp"
#include "core/parallel.hpp"
#include "core/volume.hpp"
#include "ops/heights.hpp"
#include "ops/measure.hpp"
#include "ops/parameters.hpp"

namespace terrane {
namespace {

std::string crs_id(const Crs& crs) { return crs.known() ? crs.id() : ""; }

nlohmann::json output_json(const Inspection& seen, const Crs& crs, double area_2d) {
  const Units units = units_of(crs);
  return {{"crs", crs_id(crs)},
          {"units", {{"length", units.length}, {"height", units.height}, {"area", units.area}}},
          {"vertices", seen.vertices},
          {"faces", seen.faces},
          {"walls", seen.walls},
          {"components", seen.components},
          {"holes", seen.holes},
          {"area_2d", area_2d}};
}

/// What is not exact by design: rasters that were simplified.
nlohmann::json approximation(const Plan& plan, const Frame& frame, const std::vector<Surface>& surfaces) {
  const bool raster =
      std::any_of(frame.inputs.begin(), frame.inputs.end(), [](const InputRecord& r) { return r.raster; });
  const auto asked = plan.parameters.find("max-error");
  if (!raster || asked == plan.parameters.end()) return nullptr;
  double measured = 0;
  for (const Surface& s : surfaces) measured = std::max(measured, s.max_error);
  if (measured == 0 && *asked == 0) return nullptr;
  return {
      {"max_error", *asked}, {"measured", measured}, {"against", "every sample of the rasters, in the result's CRS"}};
}

nlohmann::json rounding_json(const RoundingReport& r) {
  return {{"max_move", r.max_move}, {"max_snap", r.max_snap}, {"max_spill", r.max_spill},
          {"snapped", r.snapped},   {"merges", r.merges},     {"flips", r.flips},
          {"kinetic", r.kinetic},   {"lost", r.lost},         {"regions", r.regions},
          {"collapsed", r.collapsed}};
}

/// All ways of leaving out inputs whose border is so near that the place may lie outside them.
bool next_subset(std::vector<bool>& out, const std::vector<bool>& may) {
  for (std::size_t i = 0; i < may.size(); ++i) {
    if (!may[i]) continue;
    out[i] = !out[i];
    if (out[i]) return true;
  }
  return false;
}

/// One vertex of the result, with its inputs near a border taken to be there or not, as fits better.
void check_height(const Point& p, const HeightFields& fields, const HeightFold& fold, double radius,
                  HeightCheck& check) {
  std::vector<std::optional<HeightRange>> z(fields.size());
  std::vector<bool> border(fields.size()), out(fields.size());
  std::size_t optional_count = 0;
  for (std::size_t i = 0; i < fields.size(); ++i)
    if (const auto reading = fields[i]->at(plan(p), radius); reading.found) {
      z[i] = reading.height;
      border[i] = reading.border && ++optional_count <= 10;
    }
  double error = std::numeric_limits<double>::infinity();
  do {
    auto present = z;
    for (std::size_t i = 0; i < out.size(); ++i)
      if (out[i]) present[i].reset();
    if (const auto expected = fold(present))
      error = std::min(error, std::max({0.0, expected->low - p.z, p.z - expected->high}));
  } while (next_subset(out, border));
  if (std::isinf(error)) return;  // outside every input by rounding: nothing to compare with
  check.max_error = std::max(check.max_error, error);
  ++check.points;
}

/// Per vertex, whether a face has it that is no wall: what skirts and parapets reach is no height of the surface. Of a
/// TIN without walls empty; in canonical order the two vertices at one place that a wall has follow each other.
std::vector<bool> on_ground(const Tin& tin) {
  const auto& v = tin.vertices;
  const auto above = [](const Point& p, const Point& q) { return plan(p) == plan(q); };
  if (std::adjacent_find(v.begin(), v.end(), above) == v.end()) return {};
  std::vector<bool> ground(v.size());
  for (const Face& f : tin.faces)
    if (!is_wall(tin, f))
      for (const Index corner : f) ground[corner] = true;
  return ground;
}

}  // namespace

HeightCheck check_heights(const Tin& result, const HeightFields& fields, const HeightFold& fold,
                          const RoundingReport& rounding, Context& context) {
  if (!fold || result.vertices.empty()) return {};
  context.progress("verify", 0);
  const Box box = bounds(result.vertices, context);
  const double largest = std::max({std::fabs(box.xmin), std::fabs(box.xmax), std::fabs(box.ymin), std::fabs(box.ymax)});
  const double radius = 2 * (rounding.max_move + rounding.max_snap) + 4 * 2.3e-16 * largest;
  const std::size_t step = std::max<std::size_t>(1, result.vertices.size() / 5000), chunk = 512 * step;
  const std::vector<bool> ground = on_ground(result);
  std::vector<HeightCheck> checks(result.vertices.size() / chunk + 1);
  parallel_for(context, result.vertices.size(), chunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t v = first; v < last; v += step)
      if (ground.empty() || ground[v]) check_height(result.vertices[v], fields, fold, radius, checks[first / chunk]);
  });
  HeightCheck all;
  for (const HeightCheck& check : checks) {
    all.points += check.points;
    all.max_error = std::max(all.max_error, check.max_error);
  }
  return all;
}

void warn_of_skirts(const std::vector<Surface>& surfaces, const Tin& result, Context& context) {
  const auto skirted = [](const Tin& tin) {
    const std::vector<bool> ground = on_ground(tin);
    return std::find(ground.begin(), ground.end(), false) != ground.end();
  };
  for (const Surface& s : surfaces)
    if (const Tin* tin = std::get_if<Tin>(&s.value); tin && skirted(*tin) && !skirted(result))
      context.warn({"skirts-left-out", s.name, "",
                    "walls of '" + s.name + "' that reach below or above its surface are not in the result",
                    "add them again with what made them"});
}

nlohmann::json warnings_json(const std::vector<Warning>& warnings) {
  nlohmann::json list = nlohmann::json::array();
  for (const Warning& w : warnings)
    list.push_back(
        {{"code", w.code}, {"input", w.input}, {"element", w.element}, {"message", w.message}, {"remedy", w.remedy}});
  return list;
}

nlohmann::json deciding(const nlohmann::json& parameters) {
  nlohmann::json kept = nlohmann::json::object();
  for (const auto& [name, value] : parameters.items())
    if (!value.is_null() && name != "threads" && name != "format" && name != "provenance") kept[name] = value;
  return kept;
}

nlohmann::json inputs_json(const Frame& frame) {
  nlohmann::json list = nlohmann::json::array();
  for (const InputRecord& r : frame.inputs) {
    if (!r.word.empty()) {
      list.push_back({{"input", r.slot}, {"word", r.word}});
      continue;
    }
    if (r.level) {
      list.push_back({{"input", r.slot}, {"level", *r.level}});
      continue;
    }
    nlohmann::json entry = {{"input", r.slot},
                            {"name", r.name},
                            {"sha256", r.sha256},
                            {"crs", crs_id(r.crs)},
                            {"vertical_datum", r.crs.known() ? r.crs.vertical_datum() : "unknown"},
                            {"vertices", r.vertices},
                            {"faces", r.faces},
                            {"area_2d", r.area_2d ? nlohmann::json(*r.area_2d) : nlohmann::json()}};
    if (!r.joined.empty()) entry["joined"] = r.joined, entry["vertices"] = nullptr, entry["faces"] = nullptr;
    list.push_back(std::move(entry));
  }
  return list;
}

nlohmann::json certificate(const Plan& plan, const Frame& frame, const std::vector<Surface>& surfaces,
                           const Outcome& outcome, const Inspection& seen, const HeightCheck& heights,
                           const Context& context) {
  const Tin& tin = std::get<Tin>(outcome.result);
  const RoundingReport rounding = outcome.rounding.value_or(RoundingReport{});
  const double in_plan = plan_area(tin, context);
  nlohmann::json approximated = outcome.approximation;
  if (approximated.is_null()) approximated = nlohmann::json::object();
  if (!approximated.contains("max_error"))  // else it tells the whole
    if (const nlohmann::json rasters = approximation(plan, frame, surfaces); !rasters.is_null())
      approximated.update(rasters);
  if (approximated.empty()) approximated = nullptr;
  nlohmann::json balance;
  if (outcome.expected_area) {
    // In squared CRS units, degrees included: this is about the mesh, not about the ground.
    const double actual = in_plan;
    balance = {{"expected", *outcome.expected_area}, {"actual", actual}, {"residual", actual - *outcome.expected_area}};
  }
  nlohmann::json made = {{"type", "Certificate"},
                         {"software", std::string("terrane ") + TERRANE_VERSION},
                         {"operation", plan.operation->id},
                         {"parameters", deciding(plan.parameters)},
                         {"inputs", inputs_json(frame)},
                         {"output", output_json(seen, frame.crs, domain_area(tin, frame.crs, in_plan))},
                         {"topology",
                          {{"inverted", seen.inverted},
                           {"degenerate", seen.degenerate},
                           {"t_junctions", seen.t_junctions},
                           {"non_manifold_edges", seen.non_manifold_edges}}},
                         {"accuracy",
                          {{"max_plan_shift", std::max(rounding.max_move, rounding.max_snap)},
                           {"max_height_error", heights.max_error},
                           {"points_checked", heights.points},
                           {"approximation", approximated}}},
                         {"rounding", outcome.rounding ? rounding_json(rounding) : nlohmann::json()},
                         {"area_balance", balance},
                         {"reprojection", frame.reprojection},
                         {"warnings", warnings_json(context.warnings)}};
  made.update(outcome.certificate);
  return made;
}

nlohmann::json embedded(const nlohmann::json& whole) {
  nlohmann::json kept = whole;
  for (const char* part : {"warnings", "seams", "area_balance", "rounding"}) kept.erase(part);
  auto& inputs = kept["inputs"];
  for (auto& entry : inputs) entry.erase("name"), entry.erase("joined");
  std::sort(inputs.begin(), inputs.end(), [](const nlohmann::json& a, const nlohmann::json& b) {
    const auto key = [](const nlohmann::json& e) { return std::pair(e.value("input", ""), e.value("sha256", "")); };
    return key(a) < key(b);
  });
  // INPUT:CRS may name files; which CRS an input was in stands with the input.
  if (kept.contains("parameters")) kept["parameters"].erase("crs"), kept["parameters"].erase("assume-crs");
  return kept;
}

}  // namespace terrane
