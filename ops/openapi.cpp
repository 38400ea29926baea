// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/describe.hpp"
#include "ops/yaml.hpp"

// The service as OpenAPI 3.1, made from the catalogue.
namespace terrane {
namespace {

using Json = nlohmann::json;

Json reference(const std::string& name) { return {{"$ref", "#/components/schemas/" + name}}; }

Json json_response(const std::string& description, const Json& schema) {
  return {{"description", description}, {"content", {{"application/json", {{"schema", schema}}}}}};
}

Json problem_response(const std::string& description) {
  return {{"description", description},
          {"content", {{"application/problem+json", {{"schema", reference("problem")}}}}}};
}

Json get(const std::string& id, const std::string& summary, const Json& schema, bool may_miss = false) {
  Json responses = {{"200", json_response(summary, schema)}};
  if (may_miss) responses["404"] = problem_response("There is no such thing.");
  return {{"get", {{"operationId", id}, {"summary", summary}, {"responses", responses}}}};
}

/// A small tent of a surface, different for each input, for examples that can be replayed as they stand.
Json example_surface(double lift) {
  return {
      {"type", "TIN"},
      {"crs", "EPSG:25831"},
      {"vertices",
       {{470000, 4380000, lift}, {470100, 4380000, lift + 5}, {470100, 4380100, lift}, {470000, 4380100, lift + 2}}},
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
    "ncols 3\nnrows 3\nxllcenter 470000\nyllcenter 4380000\ncellsize 50\nNODATA_value -9999\n1 2 3\n2 4 4\n3 3 5\n";

Json example_inputs(const Operation& operation) {
  Json inputs = Json::object();
  const bool takes_binary = std::any_of(operation.parameters.begin(), operation.parameters.end(),
                                        [](const Parameter& p) { return p.name == "extent"; });
  double lift = 10;
  for (const InputSlot& slot : operation.inputs) {
    Json value = {{"value", example_surface(lift)}, {"mediaType", "application/json"}};
    if (takes_binary) value["value"] = example_level(lift > 9 ? 255 : 0);
    if (operation.intake.raster_only) value = {{"value", example_grid}, {"mediaType", "application/x-esri-ascii-grid"}};
    inputs[slot.name] = slot.max_occurs == 1 ? value : Json::array({value});
    lift -= 3;
  }
  for (const auto& [name, value] : operation.example.parameters) inputs[name] = value;
  return {{"inputs", inputs}};
}

Json json_body_schema(const Operation& operation) {
  Json properties = Json::object(), required = Json::array();
  const Json described = process_description(operation)["inputs"];
  for (const auto& [name, input] : described.items()) {
    Json schema = input["schema"];
    if (input["maxOccurs"] == "unbounded") schema = {{"oneOf", {schema, {{"type", "array"}, {"items", schema}}}}};
    schema["description"] = input["description"];
    properties[name] = schema;
    if (input["minOccurs"] != 0) required.push_back(name);
  }
  Json inputs = {{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
  if (!required.empty()) inputs["required"] = required;
  return {{"type", "object"},
          {"required", {"inputs"}},
          {"properties",
           {{"inputs", inputs},
            {"outputs", {{"type", "object"}}},
            {"response", {{"type", "string"}, {"enum", {"raw", "document"}}, {"default", "raw"}}}}}};
}

Json form_schema(const Operation& operation) {
  Json properties = Json::object(), required = Json::array();
  for (const InputSlot& slot : operation.inputs) {
    const Json file = {{"type", "string"}, {"format", "binary"}};
    properties[slot.name] = slot.max_occurs == 1 ? file : Json{{"type", "array"}, {"items", file}};
    properties[slot.name]["description"] = slot.sentence;
    if (slot.min_occurs > 0) required.push_back(slot.name);
  }
  const std::vector<Parameter> common = common_parameters_of(operation);
  for (const auto* list : {&operation.parameters, &common})
    for (const Parameter& p : *list) {
      properties[p.name] = parameter_schema(p);
      properties[p.name]["description"] = p.sentence;
    }
  Json schema = {{"type", "object"}, {"properties", properties}};
  if (!required.empty()) schema["required"] = required;
  return schema;
}

Json query_parameters(const Operation& operation) {
  Json list = Json::array();
  list.push_back({{"name", "f"},
                  {"in", "query"},
                  {"description", "The format of the result; goes before Accept."},
                  {"schema", {{"type", "string"}, {"enum", operation.output_formats}}}});
  const std::vector<Parameter> common = common_parameters_of(operation);
  for (const auto* parameters : {&operation.parameters, &common})
    for (const Parameter& p : *parameters)
      list.push_back({{"name", p.name}, {"in", "query"}, {"description", p.sentence}, {"schema", parameter_schema(p)}});
  return list;
}

Json execution(const Operation& operation) {
  Json content = Json::object();
  for (const std::string& word : operation.output_formats) {
    const std::string type = media_type_of(word);
    content[type] = {{"schema", word == "json" ? Json{{"type", "object"}} : Json{{"type", "string"}}}};
  }
  return {
      {"post",
       {{"operationId", "execute-" + operation.id},
        {"summary", operation.title},
        {"description", operation.description},
        {"tags", {"operations"}},
        {"parameters", query_parameters(operation)},
        {"requestBody",
         {{"required", true},
          {"content",
           {{"multipart/form-data", {{"schema", form_schema(operation)}}},
            {"application/json", {{"schema", json_body_schema(operation)}, {"example", example_inputs(operation)}}}}}}},
        {"responses",
         {{"200",
           {{"description", "The result."},
            {"headers",
             {{"Terrane-Warnings",
               {{"description", "How many warnings the certificate holds."}, {"schema", {{"type", "integer"}}}}},
              {"Link", {{"description", "rel=describedby: the certificate."}, {"schema", {{"type", "string"}}}}}}},
            {"content", content}}},
          {"400", problem_response("The request is not understood: parameters, inputs or format.")},
          {"405", problem_response("An execution is a POST.")},
          {"406", problem_response("No media type that is accepted can be returned.")},
          {"411", problem_response("The body has neither a length nor chunks.")},
          {"413", problem_response("Larger than the limits.")},
          {"415", problem_response("An input is in a format that is not read.")},
          {"422", problem_response("An input cannot be worked on; the message names the element and the remedy.")},
          {"503", problem_response("Busy: Retry-After says when to come again.")}}}}}};
}

Json schemas() {
  const Json text = {{"type", "string"}}, object = {{"type", "object"}};
  return {
      {"problem",
       {{"type", "object"},
        {"description", "RFC 7807."},
        {"required", {"type", "title", "status", "detail"}},
        {"properties", {{"type", text}, {"title", text}, {"status", {{"type", "integer"}}}, {"detail", text}}}}},
      {"process",
       {{"type", "object"},
        {"required", {"id", "version", "inputs", "outputs"}},
        {"description", "OGC API - Processes, process.yaml."}}},
      {"processList",
       {{"type", "object"},
        {"required", {"processes", "links"}},
        {"properties",
         {{"processes", {{"type", "array"}, {"items", object}}}, {"links", {{"type", "array"}, {"items", object}}}}}}},
      {"landingPage",
       {{"type", "object"},
        {"required", {"links"}},
        {"properties", {{"links", {{"type", "array"}, {"items", object}}}}}}},
      {"confClasses",
       {{"type", "object"},
        {"required", {"conformsTo"}},
        {"properties", {{"conformsTo", {{"type", "array"}, {"items", text}}}}}}}};
}

}  // namespace

nlohmann::json openapi() {
  Json paths = {
      {"/", get("landing", "What this service offers.", reference("landingPage"))},
      {"/conformance", get("conformance", "The conformance classes that are met.", reference("confClasses"))},
      {"/processes", get("processes", "Every operation.", reference("processList"))},
      {"/health", get("health", "Whether the service is alive.", {{"type", "object"}})},
      {"/ready", get("ready", "Whether the service takes work.", {{"type", "object"}})},
      {"/reports/{id}", get("report", "A certificate, kept for a while after its result.", {{"type", "object"}}, true)},
      {"/openapi.json", get("openapi", "This document.", {{"type", "object"}})}};
  Json ids = Json::array();
  for (const Operation& operation : catalogue()) ids.push_back(operation.id);
  paths["/processes/{id}"] =
      get("process", "One operation: its inputs, parameters and outputs.", reference("process"), true);
  paths["/processes/{id}"]["parameters"] = {
      {{"name", "id"}, {"in", "path"}, {"required", true}, {"schema", {{"type", "string"}, {"enum", ids}}}}};
  paths["/reports/{id}"]["parameters"] = {
      {{"name", "id"}, {"in", "path"}, {"required", true}, {"schema", {{"type", "string"}}}}};
  for (const Operation& operation : catalogue())
    paths["/processes/" + operation.id + "/execution"] = execution(operation);
  return {{"openapi", "3.1.0"},
          {"info",
           {{"title", "Terrane"},
            {"version", TERRANE_VERSION},
            {"description", "Exact algebra on terrain surfaces (TINs), as OGC API - Processes."},
            {"license", {{"name", "GPL-3.0-or-later"}, {"identifier", "GPL-3.0-or-later"}}}}},
          {"paths", paths},
          {"components", {{"schemas", schemas()}}}};
}

std::string openapi_yaml() {
  return "# Generated by `terrane docs openapi`; a test fails when it is stale.\n" + yaml(openapi());
}

}  // namespace terrane
