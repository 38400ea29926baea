// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/openapi/openapi_parts.hpp"

// The schemas of OGC API - Processes 1.0, in our words.
namespace terrane::openapi_parts {
namespace {

using Json = nlohmann::json;

const Json text = {{"type", "string"}};
const Json uri = {{"type", "string"}, {"format", "uri"}};
const Json object = {{"type", "object"}};

Json record(const std::vector<std::string>& required, const Json& properties, const char* description = nullptr) {
  Json made = {{"type", "object"}, {"properties", properties}};
  if (!required.empty()) made["required"] = required;
  if (description) made["description"] = description;
  return made;
}

Json words(const std::vector<std::string>& list) { return {{"type", "string"}, {"enum", list}}; }

Json status_info() {
  const Json moment = {{"type", "string"}, {"format", "date-time"}};
  return record({"jobID", "status", "type"},
                {{"processID", text},
                 {"type", words({"process"})},
                 {"jobID", text},
                 {"status", schema("statusCode")},
                 {"message", text},
                 {"created", moment},
                 {"started", moment},
                 {"finished", moment},
                 {"updated", moment},
                 {"progress", {{"type", "integer"}, {"minimum", 0}, {"maximum", 100}}},
                 {"links", array_of(schema("link"))}},
                "How far a job is.");
}

Json process_schemas() {
  Json summary = record({"id", "version"}, {{"id", text},
                                            {"title", text},
                                            {"description", text},
                                            {"version", text},
                                            {"jobControlOptions", array_of(schema("jobControlOptions"))},
                                            {"outputTransmission", array_of(schema("transmissionMode"))},
                                            {"links", array_of(schema("link"))}});
  Json process = summary;
  process["properties"]["inputs"] = {{"type", "object"}, {"additionalProperties", schema("inputDescription")}};
  process["properties"]["outputs"] = {{"type", "object"}, {"additionalProperties", schema("outputDescription")}};
  const Json many = {{"oneOf", {{{"type", "integer"}}, words({"unbounded"})}}};
  return {{"processSummary", summary},
          {"process", process},
          {"processList", record({"processes", "links"}, {{"processes", array_of(schema("processSummary"))},
                                                          {"links", array_of(schema("link"))}})},
          {"inputDescription", record({"schema"}, {{"title", text},
                                                   {"description", text},
                                                   {"minOccurs", {{"type", "integer"}, {"default", 1}}},
                                                   {"maxOccurs", many},
                                                   {"schema", object}})},
          {"outputDescription", record({"schema"}, {{"title", text}, {"description", text}, {"schema", object}})},
          {"jobControlOptions", words({"sync-execute", "async-execute", "dismiss"})},
          {"transmissionMode", words({"value", "reference"})}};
}

Json execute_schemas() {
  const Json format = record({}, {{"mediaType", text}, {"encoding", text}, {"schema", {{"oneOf", {text, object}}}}});
  Json qualified = format;
  qualified["properties"]["value"] = Json::object();
  qualified["required"] = {"value"};
  qualified["description"] = "A value that says what it is.";
  const Json result = {{"oneOf",
                        {text,
                         {{"type", "number"}},
                         {{"type", "boolean"}},
                         {{"type", "array"}, {"items", Json::object()}},
                         schema("qualifiedValue"),
                         schema("link")}}};
  return {{"format", format},
          {"qualifiedValue", qualified},
          {"results",
           {{"type", "object"},
            {"description", "Outputs by name, each by value or by reference."},
            {"additionalProperties", result}}},
          {"outputs",
           {{"type", "object"},
            {"description", "Which outputs are wanted and how; all of them when this is left out."},
            {"additionalProperties",
             record({}, {{"format", schema("format")}, {"transmissionMode", schema("transmissionMode")}})}}},
          {"response",
           {{"type", "string"},
            {"enum", {"raw", "document"}},
            {"default", "raw"},
            {"description", "Outputs as themselves, or all of them in one JSON document."}}},
          {"subscriber", record({"successUri"}, {{"successUri", uri}, {"inProgressUri", uri}, {"failedUri", uri}},
                                "Where to send word of a job.")}};
}

}  // namespace

Json schemas() {
  const Json links = array_of(schema("link"));
  Json all = {
      {"exception",
       record(
           {"type"},
           {{"type", text}, {"title", text}, {"status", {{"type", "integer"}}}, {"detail", text}, {"instance", text}},
           "What went wrong (RFC 7807).")},
      {"link", record({"href"}, {{"href", text}, {"rel", text}, {"type", text}, {"hreflang", text}, {"title", text}})},
      {"landingPage", record({"links"}, {{"title", text}, {"description", text}, {"links", links}})},
      {"confClasses", record({"conformsTo"}, {{"conformsTo", array_of(text)}})},
      {"statusCode", words({"accepted", "running", "successful", "failed", "dismissed"})},
      {"statusInfo", status_info()},
      {"jobList", record({"jobs", "links"}, {{"jobs", array_of(schema("statusInfo"))}, {"links", links}})}};
  all.update(process_schemas());
  all.update(execute_schemas());
  return all;
}

}  // namespace terrane::openapi_parts
