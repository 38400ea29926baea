// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/openapi/describe.hpp"

#include <algorithm>
#include <utility>

#include "ops/memory.hpp"

namespace terrane {
namespace {

std::string title_of(const std::string& name) {
  std::string title = name;
  std::replace(title.begin(), title.end(), '-', ' ');
  if (!title.empty()) title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  return title;
}

nlohmann::json bytes_schema(const std::string& media_type) {
  return {{"type", "string"}, {"contentEncoding", "binary"}, {"contentMediaType", media_type}};
}

nlohmann::json input_schema(const Operation& operation, const InputSlot& slot) {
  nlohmann::json kinds = nlohmann::json::array();
  if (operation.run_plain) {
    for (const char* type : {"application/octet-stream", "image/tiff", "image/png"})
      kinds.push_back(bytes_schema(type));
    return {{"oneOf", kinds}};
  }
  kinds.push_back(
      {{"type", "object"}, {"description", "A TIN as Terrane JSON."}, {"contentMediaType", "application/json"}});
  for (const Format& format : formats())
    if (format.read && format.name != "json") kinds.push_back(bytes_schema(format.media_type));
  if (slot.takes_number) kinds.push_back({{"type", "number"}});
  if (!slot.word.empty()) kinds.push_back({{"type", "string"}, {"enum", {slot.word}}});
  return {{"oneOf", kinds}};
}

nlohmann::json output_schema(const Operation& operation) {
  nlohmann::json kinds = nlohmann::json::array();
  for (const std::string& word : operation.output_formats) {
    const std::string type = media_type_of(word);
    if (word == "json")
      kinds.push_back({{"type", "object"}, {"contentMediaType", type}});
    else if (word == "csv")
      kinds.push_back({{"type", "string"}, {"contentMediaType", type}});
    else
      kinds.push_back(bytes_schema(type));
  }
  if (kinds.size() == 1) return kinds.front();
  return {{"oneOf", kinds}};
}

/// OGC API - Processes, additionalParameters: what the memory of an execution is reckoned with.
nlohmann::json memory_json(const MemoryFigures& figures) {
  nlohmann::json parameters = nlohmann::json::array();
  for (const auto& [name, each] :
       {std::pair{"bytes-per-face", figures.face}, std::pair{"bytes-per-cell", figures.cell}})
    if (each.most > 0)
      parameters.push_back({{"name", name}, {"value", {{{"least", each.least}, {"most", each.most}}}}});
  return {{"title", "Memory beside the program and the request"}, {"parameters", parameters}};
}

/// The OGC name of an operation's output where it has one: surface, report or picture.
std::string output_id(const Operation& operation) {
  switch (operation.result) {
    case ResultKind::surface:
      return "surface";
    case ResultKind::picture:
      return "picture";
    case ResultKind::raster:
      return "raster";
    case ResultKind::vectors:
      return "features";
    case ResultKind::report:
    case ResultKind::table:
      break;
  }
  return "report";
}

/// The OGC descriptions of what an operation returns, by name.
nlohmann::json outputs_json(const Operation& operation) {
  nlohmann::json outputs = nlohmann::json::object();
  for (const OutputSlot& output : operation.outputs)
    outputs[output.name] = {
        {"title", title_of(output.name)}, {"description", output.sentence}, {"schema", output.schema}};
  if (!outputs.empty()) return outputs;
  return {{output_id(operation),
           {{"title", title_of(output_id(operation))},
            {"description", operation.description},
            {"schema", output_schema(operation)}}}};
}

}  // namespace

nlohmann::json parameter_schema(const Parameter& p) {
  nlohmann::json schema;
  switch (p.type) {
    case Parameter::Type::number:
      schema = {{"type", "number"}};
      break;
    case Parameter::Type::integer:
      schema = {{"type", "integer"}};
      break;
    case Parameter::Type::boolean:
      schema = {{"type", "boolean"}};
      break;
    case Parameter::Type::choice:
      schema = {{"type", "string"}, {"enum", p.choices}};
      break;
    case Parameter::Type::numbers:
      schema = {{"oneOf",
                 {{{"type", "array"}, {"items", {{"type", "number"}}}},
                  {{"type", "number"}},
                  {{"type", "string"}, {"pattern", "^[-+0-9.eE, :]+$"}}}}};
      break;
    case Parameter::Type::vectors:
      schema = {{"oneOf",
                 {{{"type", "object"}, {"description", "GeoJSON"}, {"contentMediaType", "application/geo+json"}},
                  {{"type", "string"}, {"description", "WKT, or coordinates x,y;x,y"}},
                  bytes_schema("application/geopackage+sqlite3"),
                  bytes_schema("application/zip"),
                  bytes_schema("image/vnd.dxf")}}};
      break;
    case Parameter::Type::json:
      schema = p.schema;
      break;
    case Parameter::Type::text:
    case Parameter::Type::crs:
      schema = {{"type", "string"}};
      break;
    case Parameter::Type::length: {
      nlohmann::json number = {{"type", "number"}};
      if (p.minimum) number["minimum"] = *p.minimum;
      if (p.maximum) number["maximum"] = *p.maximum;
      schema = {{"oneOf", {number, {{"type", "string"}, {"pattern", "^[-+0-9.eE]+ *(m|ft|ftUS)?$"}}}}};
      break;
    }
  }
  if (p.type == Parameter::Type::number || p.type == Parameter::Type::integer) {
    if (p.minimum) schema["minimum"] = *p.minimum;
    if (p.maximum) schema["maximum"] = *p.maximum;
  }
  if (!p.default_value.is_null()) schema["default"] = p.default_value;
  return schema;
}

nlohmann::json process_summary(const Operation& operation) {
  return {{"id", operation.id},
          {"title", operation.title},
          {"description", operation.description},
          {"version", TERRANE_VERSION},
          {"jobControlOptions", {"sync-execute", "async-execute", "dismiss"}},
          {"outputTransmission", {"value", "reference"}}};
}

nlohmann::json process_description(const Operation& operation) {
  nlohmann::json description = process_summary(operation), inputs = nlohmann::json::object();
  for (const InputSlot& slot : operation.inputs)
    inputs[slot.name] = {
        {"title", title_of(slot.name)},
        {"description", slot.sentence},
        {"minOccurs", slot.min_occurs},
        {"maxOccurs", slot.max_occurs == 0 ? nlohmann::json("unbounded") : nlohmann::json(slot.max_occurs)},
        {"schema", input_schema(operation, slot)}};
  const std::vector<Parameter> common = common_parameters_of(operation);
  for (const auto* list : {&operation.parameters, &common})
    for (const Parameter& p : *list)
      inputs[p.name] = {{"title", title_of(p.name)},
                        {"description", p.sentence},
                        {"minOccurs", 0},
                        {"maxOccurs", 1},
                        {"schema", parameter_schema(p)}};
  description["inputs"] = inputs;
  description["outputs"] = outputs_json(operation);
  const MemoryFigures figures = memory_figures(operation.id);
  if (figures.face.most > 0) description["additionalParameters"] = memory_json(figures);
  return description;
}

}  // namespace terrane
