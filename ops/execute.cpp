// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <functional>
#include <new>
#include <utility>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/validate.hpp"
#include "ops/certificate.hpp"
#include "ops/frame.hpp"
#include "ops/grid.hpp"
#include "ops/heights.hpp"
#include "ops/input_format.hpp"
#include "ops/json_value.hpp"
#include "ops/memory.hpp"
#include "ops/operation.hpp"
#include "ops/outcome.hpp"
#include "ops/provenance.hpp"
#include "ops/sha256.hpp"
#include "core/side_by_side.hpp"

// decode -> common frame -> run -> verify -> encode: the same for every door.
namespace terrane {
namespace {

/// What an input holds, and the sum of its bytes, which is made while they pass when they are not held.
Dataset read_part(const InputPart& part, const ReadOptions& options, std::string& sum, Context& context) {
  const Format& format = input_format(part);
  if (!part.open) {
    sum = sha256(part.bytes);
    return format.read(part.bytes, options, context);
  }
  Sha256 passed;
  InputStream stream = part.open();
  std::size_t left = stream.size;
  const auto fill = [&](char* to, std::size_t size) {
    const std::size_t count = stream.fill(to, std::min(size, left));
    passed.add({to, count});
    left -= count;
    return count;
  };
  Dataset data = format.read(Source(fill, stream.size), options, context);
  std::vector<char> unread(1 << 16);
  while (left != 0 && fill(unread.data(), unread.size()) != 0) continue;
  sum = passed.finish();
  return data;
}

/// What an operation says of how its inputs are read.
ReadOptions read_options(const std::string& name, const nlohmann::json& parameters) {
  ReadOptions options{.name = name};
  options.columns = parameters.value("columns", "");
  if (const auto classes = parameters.find("classes"); classes != parameters.end())
    for (const double code : classes->get<std::vector<double>>()) options.classes.push_back(static_cast<int>(code));
  return options;
}

/// Errors of readers and of validation name the input by its label; a memory limit does too.
Surface decode(const InputPart& part, const InputSlot& slot, const Plan& plan, Context& context) {
  const Operation& operation = *plan.operation;
  Surface surface{part.slot, label(part), "", 0.0, {}, nullptr, 0};
  if (is_word(part, slot)) {
    surface.word = slot.word;
    return surface;
  }
  if (const auto level = level_of(part, slot)) {
    surface.sha256 = sha256(part.bytes);
    surface.value = level->value;
    surface.level_unit = level->unit;
    return surface;
  }
  Dataset data = read_part(part, read_options(surface.name, plan.parameters), surface.sha256, context);
  surface.crs = data.crs;
  surface.height_unit = data.height_unit;
  if (slot.lattice && !std::holds_alternative<Raster>(data.surface))
    throw Error(ErrorKind::input, "not-a-raster",
                "input '" + surface.name + "' is a TIN; '" + slot.name + "' takes a raster, whose cells are copied");
  if (Raster* dem = std::get_if<Raster>(&data.surface)) {
    if (slot.lattice) dem->samples = {};
    surface.value = std::move(*dem);
  } else if (PointCloud* cloud = std::get_if<PointCloud>(&data.surface)) {
    if (!operation.intake.points_allowed)
      throw Error(ErrorKind::input, "no-surface",
                  "input '" + surface.name + "' holds points, and '" + operation.id +
                      "' takes surfaces; make one of them with 'triangulate'");
    surface.value = std::move(*cloud);
  } else {
    surface.value = std::move(std::get<Tin>(data.surface));
  }
  return surface;
}

/// All inputs in their order.
std::vector<Surface> decode_all(const Plan& plan, Context& context) {
  const Operation& operation = *plan.operation;
  const std::vector<InputPart>& parts = plan.request.inputs;
  context.progress("read", 0);
  std::vector<double> sizes;
  for (const InputPart& part : parts)
    sizes.push_back(static_cast<double>(part.open ? part.open().size : part.bytes.size()));
  std::vector<Surface> surfaces(parts.size());
  side_by_side(sizes, context, [&](std::size_t i, Context& own) {
    const auto slot = std::find_if(operation.inputs.begin(), operation.inputs.end(),
                                   [&](const InputSlot& s) { return s.name == parts[i].slot; });
    surfaces[i] = decode(parts[i], *slot, plan, own);
  });
  return surfaces;
}

/// A result that is not what was promised is not returned.
void refuse_unsound(const Inspection& seen, const std::string& operation) {
  if (seen.inverted + seen.degenerate + seen.t_junctions + seen.non_manifold_edges == 0) return;
  throw Error(ErrorKind::internal, "unsound-result",
              "the result of '" + operation + "' has " + std::to_string(seen.inverted) + " inverted and " +
                  std::to_string(seen.degenerate) + " degenerate faces, " + std::to_string(seen.t_junctions) +
                  " T-junctions and " + std::to_string(seen.non_manifold_edges) + " edges with too many faces");
}

/// The inputs as the operation will see them, kept while it may consume them: heights are checked against these.
std::vector<const Tin*> tins_of(const std::vector<Surface>& surfaces) {
  std::vector<const Tin*> tins;
  for (const Surface& s : surfaces)
    if (!s.level() && !s.points()) tins.push_back(&s.tin());
  return tins;
}

void encode(const Plan& plan, const Frame& frame, const Tin& tin, const WriteOptions& options, const Body& body,
            Response& response, Context& context) {
  context.progress("write", 0);
  const Format* format = format_named(plan.output_format);
  if (body.sink)
    format->write(tin, frame.crs, options, body.sink, context);
  else
    response.body = written(*format, tin, frame.crs, options, context);
}

/// Verifies a surface and encodes it: side by side where nobody sees the bytes before both are done.
void verify_and_encode(const Plan& plan, const Frame& frame, const Tin& tin, const std::function<void()>& verify,
                       const Provenance* provenance, const Body& body, Response& response, Context& context) {
  if (!body.held_back || format_named(plan.output_format)->carries_certificate) {
    verify();
    WriteOptions options;
    options.certificate_json = json_text(embedded(response.report));
    options.provenance = provenance;
    return encode(plan, frame, tin, options, body, response, context);
  }
  Context writing;  // the other one is in use
  writing.threads = context.threads;
  writing.on_progress = [&](std::string_view, double) { context.stop_if_cancelled(); };
  parallel_tasks(context, 2, [&](std::size_t i) {
    try {
      i == 0 ? verify() : encode(plan, frame, tin, {}, body, response, writing);
    } catch (...) {
      writing.cancelled = true;
      throw;
    }
  });
}

std::string extension_of(const std::string& word) {
  const Format* format = format_named(word);
  return format && word != "json" ? format->extensions.front() : "." + word;
}

/// What is no TIN, in the format that was chosen.
std::string encoded(const Outcome& outcome, const nlohmann::json& report, const std::string& word, const Crs& crs,
                    Context& context) {
  if (const auto* raster = std::get_if<Raster>(&outcome.result)) return write_raster(*raster, crs, word, context);
  if (const auto* picture = std::get_if<Picture>(&outcome.result)) return write_png(*picture);
  if (const auto* vectors = std::get_if<Vectors>(&outcome.result)) return write_vectors(*vectors, word);
  if (word == "csv") return outcome.csv();
  if (word == "png") return write_png(outcome.picture());
  if (word == "json") return json_text(report, 2) + "\n";
  Vectors made = outcome.features();
  made.crs = crs;
  return write_vectors(made, word);
}

/// Rasters that were joined have no seam between them; the seam report says so.
void name_joined(const Frame& frame, Outcome& outcome) {
  if (!outcome.certificate.contains("seams")) return;
  nlohmann::json joined = nlohmann::json::array();
  for (const InputRecord& r : frame.inputs)
    if (!r.joined.empty() && std::find(joined.begin(), joined.end(), r.joined) == joined.end())
      joined.push_back(r.joined);
  outcome.certificate["seams"]["joined"] = joined;
}

/// The part of a certificate that a report or a picture can have.
nlohmann::json report_certificate(const Plan& plan, const Frame& frame, const Context& context) {
  return {{"type", "Certificate"},
          {"software", std::string("terrane ") + TERRANE_VERSION},
          {"operation", plan.operation->id},
          {"parameters", deciding(plan.parameters)},
          {"inputs", inputs_json(frame)},
          {"reprojection", frame.reprojection},
          {"warnings", warnings_json(context.warnings)}};
}

/// The independent look at the result's heights disagrees with them: the user must not find out from the figure alone.
void warn_of_heights(const HeightCheck& heights, const Tin& tin, Context& context) {
  double largest = 1;
  if (heights.max_error <= 1e-6 * largest) return;
  for (const Point& p : tin.vertices) largest = std::max(largest, std::fabs(p.z));
  if (heights.max_error > 1e-6 * largest)
    context.warn(
        {"height-check", "", "",
         "some height of the result is " + nlohmann::json(heights.max_error).dump() + " off what the inputs say there",
         "look at the place, and report it with the inputs: results are meant to be exact"});
}

void use_threads(const Plan& plan, Context& context) {
  const auto it = plan.parameters.find("threads");
  const int asked = it == plan.parameters.end() ? 0 : it->get<int>();
  if (asked > 0) context.threads = std::min(std::max(context.threads, 1), asked);
}

/// An operation without geometry: nothing is decoded, nothing verified.
Response execute_plain(const Plan& plan, Context& context, const Body& body) {
  Outcome outcome = plan.operation->run_plain(plan, context);
  Response response;
  response.media_type = media_type_of(plan.output_format);
  response.file_name = plan.operation->id + extension_of(plan.output_format);
  response.body = json_text(std::get<nlohmann::json>(outcome.result), 2) + "\n";
  response.parts = std::move(outcome.parts);
  response.warnings = context.warnings;
  if (body.sink) body.sink(std::exchange(response.body, {}));
  return response;
}

Response execute_on_surfaces(const Plan& plan, MemoryNeed& need, Context& context, const Body& body) {
  std::vector<Surface> surfaces = decode_all(plan, context);
  need.count(surfaces);
  const Frame frame = common_frame(surfaces, plan, context);
  need.count(surfaces);  // rasters have faces now
  const Values values = {plan.parameters, vectors_in_frame(plan, surfaces, frame.crs, context), frame.crs};
  Outcome outcome = plan.operation->run(surfaces, values, context);

  Response response;
  response.media_type = media_type_of(plan.output_format);
  response.file_name = plan.operation->id + extension_of(plan.output_format);
  if (const Tin* tin = std::get_if<Tin>(&outcome.result)) {
    if (outcome.expected_height && outcome.fields.empty()) outcome.fields = height_fields(tins_of(surfaces), context);
    const auto check = [&] {
      const RoundingReport rounding = outcome.rounding.value_or(RoundingReport{});
      return check_heights(*tin, outcome.fields, outcome.expected_height, rounding, context);
    };
    if (wants_grid(plan, frame.crs)) {
      warn_of_heights(check(), *tin, context);  // later they are off by as much as vertices move on slopes
      put_on_grid(outcome, plan, frame.crs, context);
    }
    warn_of_skirts(surfaces, *tin, context);
    name_joined(frame, outcome);
    const auto verify = [&] {
      const HeightCheck heights = check();
      if (!wants_grid(plan, frame.crs)) warn_of_heights(heights, *tin, context);
      const Inspection seen = inspect(*tin, context);
      if (outcome.verify) refuse_unsound(seen, plan.operation->id);
      response.report = certificate(plan, frame, surfaces, outcome, seen, heights, context);
    };
    std::optional<Provenance> provenance;
    if (plan.parameters.value("provenance", false)) provenance = provenance_of(plan, *tin, surfaces, outcome, context);
    verify_and_encode(plan, frame, *tin, verify, provenance ? &*provenance : nullptr, body, response, context);
  } else {
    response.report = report_certificate(plan, frame, context);
    if (auto* report = std::get_if<nlohmann::json>(&outcome.result)) {
      (*report)["certificate"] = std::move(response.report);
      response.report = std::move(*report);
    } else {
      response.report.update(outcome.certificate);
    }
    if (Vectors* vectors = std::get_if<Vectors>(&outcome.result)) vectors->crs = frame.crs;
    context.progress("write", 0);
    response.body = encoded(outcome, response.report, plan.output_format, frame.crs, context);
  }
  if (body.sink && !response.body.empty()) body.sink(std::exchange(response.body, {}));
  response.warnings = context.warnings;
  context.progress("write", 1);
  return response;
}

}  // namespace

Response execute(const Plan& plan, Context& context, const Body& body) {
  if (plan.operation->run_plain) return execute_plain(plan, context, body);
  use_threads(plan, context);
  MemoryNeed need(*plan.operation);
  try {
    return execute_on_surfaces(plan, need, context, body);
  } catch (const std::bad_alloc&) {
    throw need.exceeded();
  }
}

}  // namespace terrane
