// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "ops/openapi/describe.hpp"
#include "ops/openapi/openapi_parts.hpp"

// An execution in OpenAPI, with an example that can be replayed as it stands.
namespace terrane::openapi_parts {
namespace {

using Json = nlohmann::json;

/// A small tent of a surface, different for each input.
Json example_surface(double lift) {
  return {
      {"type", "TIN"},
      {"crs", "EPSG:25831"},
      {"vertices",
       {{500000, 4400000, lift}, {500400, 4400000, lift + 5}, {500400, 4400400, lift}, {500000, 4400400, lift + 2}}},
      {"triangles", {{0, 1, 2}, {0, 2, 3}}}};
}

/// The same square, level: true or false as a whole.
Json example_level(double height) {
  Json tin = example_surface(height);
  for (Json& vertex : tin["vertices"]) vertex[2] = height;
  return tin;
}

/// An ESRI ASCII grid, for operations that take nothing but rasters.
const char* const example_grid =
    "ncols 3\nnrows 3\nxllcenter 500000\nyllcenter 4400000\ncellsize 200\nNODATA_value -9999\n1 2 3\n2 4 4\n3 3 5\n";

/// As its schema has it: numbers are no texts.
Json example_value(const Operation& operation, const std::string& name, const std::string& text) {
  using Type = Parameter::Type;
  for (const Parameter& p : operation.parameters) {
    const bool plain = p.type == Type::number || p.type == Type::integer || p.type == Type::boolean ||
                       p.type == Type::json || p.type == Type::numbers || p.type == Type::length;
    if (p.name != name || !plain) continue;
    if (const Json value = Json::parse(text, nullptr, false); !value.is_discarded()) return value;
  }
  return text;
}

Json example_inputs(const Operation& operation) {
  Json inputs = Json::object();
  const bool takes_binary = std::any_of(operation.parameters.begin(), operation.parameters.end(),
                                        [](const Parameter& p) { return p.name == "extent"; });
  double lift = 10;
  const bool has_required = std::any_of(operation.inputs.begin(), operation.inputs.end(),
                                        [](const InputSlot& slot) { return slot.min_occurs > 0; });
  for (const InputSlot& slot : operation.inputs) {
    // Where nothing is required one of several has to be chosen; one that is not may still be in the example.
    const bool is_wanted = slot.min_occurs > 0 || inputs.size() < operation.example.files.size();
    if (has_required ? !is_wanted : &slot != &operation.inputs.front()) continue;
    Json value = {{"value", example_surface(lift)}, {"mediaType", "application/json"}};
    if (takes_binary) value["value"] = example_level(lift > 9 ? 255 : 0);
    if (operation.intake.raster_only) value = {{"value", example_grid}, {"mediaType", "application/x-esri-ascii-grid"}};
    if (operation.run_plain) value = {{"value", "SGVsbG8="}, {"encoding", "base64"}, {"mediaType", "text/plain"}};
    inputs[slot.name] = slot.max_occurs == 1 ? value : Json::array({value});
    lift -= 3;
  }
  for (const auto& [name, text] : operation.example.parameters) inputs[name] = example_value(operation, name, text);
  return {{"inputs", inputs}};
}

/// The descriptions of processes say oneOf, as the standard wants it; a text can well be several of its kinds.
Json any_kind(Json described) {
  if (const auto kinds = described.find("oneOf"); kinds != described.end()) {
    described["anyOf"] = std::move(*kinds);
    described.erase("oneOf");
  }
  return described;
}

/// What may stand for an input in a request: its value as described, alone or with what it is, or a reference.
Json input_value(const Json& described) {
  return {{"anyOf", {any_kind(described), schema("qualifiedValue"), schema("link")}}};
}

Json json_body_schema(const Operation& operation) {
  Json properties = Json::object(), required = Json::array();
  const Json described = process_description(operation)["inputs"];
  for (const auto& [name, input] : described.items()) {
    Json value = input_value(input["schema"]);
    if (input["maxOccurs"] == "unbounded") value["anyOf"].push_back(array_of(value));
    value["description"] = input["description"];
    properties[name] = value;
    if (input["minOccurs"] != 0) required.push_back(name);
  }
  Json inputs = {{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
  if (!required.empty()) inputs["required"] = required;
  Json body = {{"type", "object"},
               {"properties",
                {{"inputs", inputs},
                 {"outputs", schema("outputs")},
                 {"response", schema("response")},
                 {"subscriber", schema("subscriber")}}}};
  if (!required.empty()) body["required"] = {"inputs"};
  return body;
}

Json form_schema(const Operation& operation) {
  Json properties = Json::object(), required = Json::array();
  for (const InputSlot& slot : operation.inputs) {
    const Json file = {{"type", "string"}, {"format", "binary"}};
    properties[slot.name] = slot.max_occurs == 1 ? file : array_of(file);
    properties[slot.name]["description"] = slot.sentence;
    if (slot.min_occurs > 0) required.push_back(slot.name);
  }
  const std::vector<Parameter> common = common_parameters_of(operation);
  for (const auto* list : {&operation.parameters, &common})
    for (const Parameter& p : *list) {
      properties[p.name] = any_kind(parameter_schema(p));
      properties[p.name]["description"] = p.sentence;
    }
  Json form = {{"type", "object"}, {"properties", properties}};
  if (!required.empty()) form["required"] = required;
  return form;
}

Json header_parameter(const char* name, const char* description) {
  return {{"name", name}, {"in", "header"}, {"description", description}, {"schema", {{"type", "string"}}}};
}

Json parameters(const Operation& operation) {
  Json list = Json::array();
  list.push_back(query_parameter("f", {{"type", "string"}, {"enum", operation.output_formats}},
                                 "The format of the result; goes before Accept."));
  const std::vector<Parameter> common = common_parameters_of(operation);
  for (const auto* parameters : {&operation.parameters, &common})
    for (const Parameter& p : *parameters)
      list.push_back(query_parameter(p.name, any_kind(parameter_schema(p)), p.sentence));
  list.push_back(header_parameter("Prefer", "respond-async makes it a job; synchronous without it."));
  list.push_back(header_parameter("Idempotency-Key", "A job that was accepted with this key is not made again."));
  return list;
}

Json header(const char* description, const char* type = "string") {
  return {{"description", description}, {"schema", {{"type", type}}}};
}

Json answers(const Operation& operation) {
  Json content = Json::object();
  for (const std::string& word : operation.output_formats) {
    const std::string type = media_type_of(word);
    content[type] = {{"schema", type.ends_with("json") ? Json{{"type", "object"}} : Json{{"type", "string"}}}};
  }
  content["application/json"] = {{"schema", Json::object()}};  // also every document of results
  content["multipart/related"] = {{"schema", {{"type", "string"}}}};
  if (operation.run_plain) content["*/*"] = {{"schema", {{"type", "string"}}}};  // what is sent is what comes back
  const Json result = {{"description", "The result."},
                       {"headers",
                        {{"Terrane-Warnings", header("How many warnings the certificate holds.", "integer")},
                         {"Link", header("rel=describedby: the certificate.")}}},
                       {"content", content}};
  const Json job = {{"description", "A job works on it, as Prefer: respond-async has asked."},
                    {"headers", {{"Location", header("Where the job is.")}}},
                    {"content", {{"application/json", {{"schema", schema("statusInfo")}}}}}};
  const Json references = {{"description", "Raw results by reference: they are in the Link headers."},
                           {"headers", {{"Link", header("One for each output.")}}}};
  return responses({{"200", result}, {"201", job}, {"204", references}}, {408, 411, 413, 415, 422, 507});
}

}  // namespace

Json execution_path(const Operation& operation) {
  const Json body = {{"schema", json_body_schema(operation)}, {"example", example_inputs(operation)}};
  Json post = {
      {"operationId", "execute-" + operation.id},
      {"summary", operation.title},
      {"description", operation.description},
      {"tags", {"operations"}},
      {"parameters", parameters(operation)},
      {"requestBody",
       {{"required", operation.inputs.empty() || operation.inputs.front().min_occurs > 0},
        {"content", {{"multipart/form-data", {{"schema", form_schema(operation)}}}, {"application/json", body}}}}},
      {"responses", answers(operation)}};
  for (const char* word : {"success", "inProgress", "failed"})
    post["callbacks"][word] = {{"$ref", std::string("#/components/callbacks/") + word}};
  return {{"post", post}};
}

}  // namespace terrane::openapi_parts
