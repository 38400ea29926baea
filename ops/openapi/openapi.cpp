// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/openapi/openapi_parts.hpp"
#include "ops/openapi/yaml.hpp"

// The service as OpenAPI 3.1, made from the catalogue.
namespace terrane {
namespace openapi_parts {
namespace {

using Json = nlohmann::json;

struct Refusal {
  int status;
  const char *name, *description;
  bool always;  // any operation can answer with it
};

constexpr Refusal refusals[] = {
    {400, "bad-request", "The request is not understood: parameters, inputs, format or header.", true},
    {401, "unauthorized", "This server wants a token.", true},
    {404, "not-found", "There is no such thing, or it is not there yet, or no longer.", false},
    {406, "not-acceptable", "No media type that is accepted can be returned.", true},
    {408, "timeout", "The request was sent too slowly.", false},
    {410, "gone", "The job was dismissed, and what came of it is gone.", false},
    {411, "length-required", "The body has neither a length nor chunks.", false},
    {412, "content-differs", "It is not what If-Match says any more.", false},
    {413, "too-large", "Larger than the limits, or more work than is done while a client waits.", false},
    {414, "path-too-long", "The path with its query is longer than 8192 bytes.", true},
    {415, "unsupported-media-type", "The body or an input is in a format that is not read.", false},
    {416, "range-not-satisfiable", "There is nothing in the range that was asked for.", false},
    {422, "unworkable-input", "An input cannot be worked on; the message names the element and the remedy.", false},
    {429, "too-many", "This client has too much in the works; Retry-After says when to come again.", true},
    {431, "header-too-large", "The header is too large.", true},
    {500, "internal", "Terrane failed. That is a mistake of ours, not of the request.", true},
    {503, "busy", "Busy, or stopping: Retry-After says when to come again.", true},
    {507, "storage-full", "There is no room left to keep a request or its result.", false}};

Json html_content() { return {{"schema", {{"type", "string"}}}}; }

}  // namespace

Json schema(const std::string& name) { return {{"$ref", "#/components/schemas/" + name}}; }

Json array_of(const Json& items) { return {{"type", "array"}, {"items", items}}; }

Json responses(Json given, std::initializer_list<int> further) {
  for (const Refusal& r : refusals) {
    const bool wanted = r.always || std::find(further.begin(), further.end(), r.status) != further.end();
    if (wanted) given[std::to_string(r.status)] = {{"$ref", std::string("#/components/responses/") + r.name}};
  }
  return given;
}

Json found(const Json& ok, std::initializer_list<int> further) {
  Json all = responses({{"200", ok}}, further);
  all.update(responses(Json::object(), {412, 416}));
  for (const auto& [status, name] : {std::pair{"206", "part"}, std::pair{"304", "not-modified"}})
    all[status] = {{"$ref", std::string("#/components/responses/") + name}};
  return all;
}

Json query_parameter(const std::string& name, const Json& schema, const std::string& description) {
  return {{"name", name}, {"in", "query"}, {"required", false}, {"description", description}, {"schema", schema}};
}

Json page_response(const std::string& description, const Json& schema) {
  return {{"description", description},
          {"content", {{"application/json", {{"schema", schema}}}, {"text/html", html_content()}}}};
}

namespace {

/// The responses that are the same everywhere, by name.
Json response_components() {
  Json list = {{"not-modified", {{"description", "It is what the client has, as If-None-Match says."}}},
               {"part",
                {{"description", "The range that was asked for."},
                 {"content", {{"*/*", {{"schema", {{"type", "string"}, {"format", "binary"}}}}}}}}}};
  for (const Refusal& r : refusals) {
    list[r.name] = {{"description", r.description},
                    {"content", {{"application/problem+json", {{"schema", schema("exception")}}}}}};
    if (r.status == 429 || r.status == 503)
      list[r.name]["headers"] = {
          {"Retry-After", {{"description", "Seconds to wait."}, {"schema", {{"type", "integer"}}}}}};
  }
  return list;
}

Json f_parameter() {
  return query_parameter("f", {{"type", "string"}, {"enum", {"json", "html"}}},
                         "JSON, or a page for people; goes before Accept.");
}

/// A GET of the service's description.
Json get(const std::string& id, const std::string& summary, const std::string& description, const Json& ok,
         std::initializer_list<int> further = {}) {
  return {{"get",
           {{"operationId", id},
            {"summary", summary},
            {"description", description},
            {"tags", {"service"}},
            {"parameters", Json::array({f_parameter()})},
            {"responses", found(ok, further)}}}};
}

Json path_parameter(const std::string& name, const Json& schema, const std::string& description) {
  return {{"name", name}, {"in", "path"}, {"required", true}, {"description", description}, {"schema", schema}};
}

/// A list that comes in parts.
Json limit_parameter() {
  Json limit = query_parameter("limit", {{"type", "integer"}, {"minimum", 1}, {"maximum", 10000}, {"default", 1000}},
                               "How many at most.");
  limit["style"] = "form";
  limit["explode"] = false;
  return limit;
}

Json openapi_response(const char* version) {
  const std::string type = std::string("application/vnd.oai.openapi+json;version=") + version;
  return {{"description", "The document."},
          {"content",
           {{type, {{"schema", {{"type", "object"}}}}},
            {"application/json", {{"schema", {{"type", "object"}}}}},
            {"text/html", html_content()}}}};
}

Json service_paths() {
  const Json object = {{"type", "object"}};
  Json paths = {
      {"/", get("getLandingPage", "What there is", "The landing page: links to everything else.",
                page_response("The landing page.", schema("landingPage")))},
      {"/conformance", get("getConformanceClasses", "What is conformed to", "The conformance classes that are met.",
                           page_response("The classes.", schema("confClasses")))},
      {"/processes", get("getProcesses", "The operations", "Every operation in short.",
                         page_response("The operations.", schema("processList")))},
      {"/processes/{processId}",
       get("getProcessDescription", "One operation", "One operation: its inputs, parameters and outputs.",
           page_response("The description.", schema("process")), {404})},
      {"/health",
       get("getHealth", "Alive?", "Answers as long as the service is alive.", page_response("It is alive.", object))},
      {"/ready",
       get("getReadiness", "Ready?", "Whether the service takes work.", page_response("It takes work.", object))},
      {"/reports/{reportId}", get("getReport", "A certificate", "A certificate, kept for a while after its result.",
                                  page_response("The certificate.", object), {404})},
      {"/api",
       get("getApi30", "This interface as OpenAPI 3.0", "The whole service in OpenAPI 3.0.", openapi_response("3.0"))},
      {"/openapi.json",
       get("getApi31", "This interface as OpenAPI 3.1", "The whole service in OpenAPI 3.1.", openapi_response("3.1"))},
      {"/docs", get("getDocs", "This interface as a page", "The whole service as a page to read.",
                    {{"description", "The page."}, {"content", {{"text/html", html_content()}}}})}};
  paths["/metrics"] = get("getMetrics", "Metrics", "What the service does, for Prometheus.",
                          {{"description", "The metrics."}, {"content", {{"text/plain", html_content()}}}});
  paths["/metrics"]["get"].erase("parameters");
  // Whoever looks whether the service lives needs no token.
  for (const char* path : {"/health", "/ready"}) paths[path]["get"]["security"] = Json::array();
  paths["/docs"]["get"]["parameters"][0]["schema"]["enum"] = {"html"};
  Json& list = paths["/processes"]["get"]["parameters"];
  list.push_back(limit_parameter());
  list.push_back(query_parameter("offset", {{"type", "integer"}, {"minimum", 0}, {"default", 0}}, "How many to skip."));
  Json ids = Json::array();
  for (const Operation& operation : catalogue()) ids.push_back(operation.id);
  paths["/processes/{processId}"]["parameters"] = {
      path_parameter("processId", {{"type", "string"}, {"enum", ids}}, "The name of the operation.")};
  paths["/reports/{reportId}"]["parameters"] = {
      path_parameter("reportId", {{"type", "string"}}, "As the Link of a result says it.")};
  return paths;
}

Json tag(const char* name, const char* description) { return {{"name", name}, {"description", description}}; }

}  // namespace
}  // namespace openapi_parts

nlohmann::json openapi() {
  using namespace openapi_parts;
  nlohmann::json paths = service_paths();
  paths.update(job_paths());
  for (const Operation& operation : catalogue())
    paths["/processes/" + operation.id + "/execution"] = execution_path(operation);
  const nlohmann::json nothing = nlohmann::json::object();
  return {{"openapi", "3.1.0"},
          {"info",
           {{"title", "Terrane"},
            {"version", TERRANE_VERSION},
            {"description", "Exact algebra on terrain surfaces (TINs), as OGC API - Processes."},
            {"contact", {{"name", "Whoever runs this server"}}},
            {"license", {{"name", "GPL-3.0-or-later"}, {"identifier", "GPL-3.0-or-later"}}}}},
          {"servers", {{{"url", "/"}, {"description", "This server."}}}},
          {"tags",
           {tag("service", "What there is."), tag("operations", "Executions."),
            tag("jobs", "Executions in the background."), tag("data", "Data for later.")}},
          {"security", {nothing, {{"token", nlohmann::json::array()}}}},
          {"paths", paths},
          {"components",
           {{"schemas", schemas()},
            {"responses", response_components()},
            {"callbacks", callbacks()},
            {"securitySchemes",
             {{"token",
               {{"type", "http"},
                {"scheme", "bearer"},
                {"description", "Where the server was started with --token-file; without one nothing is asked."}}}}}}}};
}

std::string openapi_yaml() {
  return "# Generated by `terrane docs openapi`; a test fails when it is stale.\n" + yaml(openapi());
}

}  // namespace terrane
