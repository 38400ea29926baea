// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <chrono>
#include <thread>

#include "core/error.hpp"
#include "ops/base64.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"

// The process with which clients, and the public test suite of OGC API - Processes, find out how executions behave.
namespace terrane {
namespace {

constexpr double longest_pause = 60;  // seconds
constexpr std::size_t largest_file = std::size_t{16} << 20;

using Json = nlohmann::json;

/// The standard's bounding box.
Json bbox_schema() {
  const Json numbers = {{"type", "number"}};
  return {{"type", "object"},
          {"required", {"bbox"}},
          {"properties",
           {{"bbox",
             {{"type", "array"},
              {"oneOf", {{{"minItems", 4}, {"maxItems", 4}}, {{"minItems", 6}, {"maxItems", 6}}}},
              {"items", numbers}}},
            {"crs",
             {{"type", "string"}, {"format", "uri"}, {"default", "http://www.opengis.net/def/crs/OGC/1.3/CRS84"}}}}}};
}

struct EchoParameters {
  std::string answer;
  Json array, bbox, flag, number, object;
  double pause = 0;

  void visit(Fields& f) {
    f.text("answer", answer, "A text.");
    f.json("array", array, {{"type", "array"}, {"items", {{"type", "number"}}}}, "Numbers: [1, 2, 3].");
    f.json("bbox", bbox, bbox_schema(),
           "A bounding box as the standard writes it: {\"bbox\": [west, south, east, north], \"crs\": ...}.");
    f.json("flag", flag, {{"type", "boolean"}}, "true or false.");
    f.json("number", number, {{"type", "number"}}, "A number.");
    f.json("object", object, {{"type", "object"}}, "Any JSON object.");
    f.number("pause", pause, {.minimum = 0, .maximum = longest_pause}, "seconds", "How long to wait first.");
  }
};

void wait(double seconds, Context& context) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  while (passed() < seconds) {
    context.progress("pause", passed() / seconds);
    std::this_thread::sleep_for(std::chrono::duration<double>(std::min(0.05, seconds - passed())));
  }
  context.progress("pause", 1);
}

/// All of an input.
std::string content(const InputPart& part) {
  if (!part.open) return part.bytes;
  InputStream stream = part.open();
  std::string bytes(std::min(stream.size, largest_file + 1), '\0');
  std::size_t have = 0;
  while (have < bytes.size()) {
    const std::size_t count = stream.fill(bytes.data() + have, bytes.size() - have);
    if (count == 0) break;
    have += count;
  }
  bytes.resize(have);
  return bytes;
}

Outcome run(const Plan& plan, Context& context) {
  wait(plan.parameters.at("pause"), context);
  Outcome outcome;
  Json all = Json::object();
  for (const OutputSlot& output : plan.operation->outputs) {
    const auto value = plan.parameters.find(output.name);
    if (value == plan.parameters.end()) continue;
    all[output.name] = *value;
    outcome.parts.push_back({output.name, "application/json", output.name + ".json", value->dump() + "\n"});
  }
  for (const InputPart& part : plan.request.inputs) {
    std::string bytes = content(part);
    if (bytes.size() > largest_file)
      throw Error(ErrorKind::limit, "file-too-large", "'echo' takes files of up to 16 MB");
    const std::string type = part.media_type.empty() ? "application/octet-stream" : part.media_type;
    all["file"] = {{"value", encode_base64(bytes)}, {"encoding", "base64"}, {"mediaType", type}};
    outcome.parts.push_back({"file", type, part.name.empty() ? "file" : part.name, std::move(bytes)});
  }
  outcome.result = std::move(all);
  return outcome;
}

/// A parameter comes back as an output of the same name.
std::vector<OutputSlot> outputs_of(const std::vector<Parameter>& parameters, const InputSlot& file) {
  std::vector<OutputSlot> outputs;
  for (const Parameter& p : parameters) {
    if (p.name == "pause") continue;
    const Json schema = p.type == Parameter::Type::json ? p.schema : Json{{"type", "string"}};
    outputs.push_back({p.name, schema, "What was given as " + p.name + "."});
  }
  outputs.push_back(
      {file.name,
       {{"type", "string"}, {"contentEncoding", "binary"}, {"contentMediaType", "application/octet-stream"}},
       "The same bytes with the same media type."});
  return outputs;
}

}  // namespace

Operation echo() {
  Operation echo = {
      .id = "echo",
      .title = "Give back what was sent",
      .description =
          "Every input comes back as the output of the same name, after a pause. Made for trying out clients: "
          "executions, jobs, progress, cancelling, the ways in which results can be had. It knows no "
          "surfaces, and none of the parameters that the other operations share.",
      .inputs = {{"file", 0, 1, false, "Any file of up to 16 MB."}},
      .parameters = described<EchoParameters>(),
      .output_formats = {"json"},
      .run_plain = run,
      .result = ResultKind::report,
      .example = {.files = {"west.tif"}, .parameters = {{"answer", "hello"}, {"pause", "1"}}}};
  echo.outputs = outputs_of(echo.parameters, echo.inputs.front());
  return echo;
}

}  // namespace terrane
