// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/openapi/openapi_parts.hpp"

// Jobs and uploads in OpenAPI; the list's parameters are those of OGC API - Processes.
namespace terrane::openapi_parts {
namespace {

using Json = nlohmann::json;

const Json text = {{"type", "string"}};

Json operation(const std::string& id, const std::string& summary, const std::string& description, const char* tag,
               const Json& parameters, const Json& answers) {
  Json made = {
      {"operationId", id}, {"summary", summary}, {"description", description}, {"tags", {tag}}, {"responses", answers}};
  if (!parameters.empty()) made["parameters"] = parameters;
  return made;
}

Json f_parameter() {
  return query_parameter("f", {{"type", "string"}, {"enum", {"json", "html"}}},
                         "JSON, or a page for people; goes before Accept.");
}

Json list_parameters() {
  Json limit = query_parameter("limit", {{"type", "integer"}, {"minimum", 1}, {"maximum", 1000}, {"default", 10}},
                               "How many jobs at most.");
  Json longest = query_parameter("maxDuration", array_of({{"type", "integer"}}),
                                 "Jobs that took at most so many seconds; of several the least counts.");
  longest["style"] = "form";
  longest["explode"] = false;
  return {query_parameter("type", array_of({{"type", "string"}, {"enum", {"process"}}}), "What kind of jobs."),
          query_parameter("processID", array_of(text), "Jobs of these operations."),
          query_parameter("status", array_of(schema("statusCode")), "Jobs with one of these statuses."),
          query_parameter("datetime", text,
                          "Jobs created then: a date-time (RFC 3339), or an interval of two with / between; .. or "
                          "nothing leaves one end open."),
          query_parameter("minDuration", array_of({{"type", "integer"}}),
                          "Jobs that took at least so many seconds; of several the most counts."),
          longest,
          limit,
          query_parameter("offset", {{"type", "integer"}, {"minimum", 0}, {"default", 0}}, "How many jobs to skip."),
          f_parameter()};
}

Json path_parameter(const char* name, const char* description) {
  return {{"name", name}, {"in", "path"}, {"required", true}, {"description", description}, {"schema", text}};
}

Json binary() { return {{"type", "string"}, {"format", "binary"}}; }

Json result_answers(const std::string& description, Json ok) {
  ok["description"] = description;
  ok["headers"] = {{"ETag", {{"description", "Of the bytes."}, {"schema", text}}}};
  return found(ok, {404, 410});
}

Json results_paths() {
  const Json raw = {{"description", "The one output, where it was asked for raw."}};
  Json all = result_answers("The results, wrapped as the execute request said.",
                            {{"content",
                              {{"application/json", {{"schema", {{"anyOf", {schema("results"), raw}}}}}},
                               {"multipart/related", {{"schema", binary()}}},
                               {"*/*", {{"schema", binary()}}}}}});
  all["204"] = {{"description", "Raw results by reference: they are in the Link headers."},
                {"headers", {{"Link", {{"description", "One for each output."}, {"schema", text}}}}}};
  all["422"] = {{"$ref", "#/components/responses/unworkable-input"}};  // a failed job answers as it would have at once
  all["413"] = {{"$ref", "#/components/responses/too-large"}};
  all["415"] = {{"$ref", "#/components/responses/unsupported-media-type"}};
  Json one = result_answers(
      "The output itself.",
      {{"content", {{"application/json", {{"schema", Json::object()}}}, {"*/*", {{"schema", binary()}}}}}});
  for (const char* status : {"413", "415", "422"}) one[status] = all[status];
  one["507"] = {{"$ref", "#/components/responses/storage-full"}};
  const Json job = path_parameter("jobId", "As the Location of the job says it."),
             output = path_parameter("output", "The name of an output, or certificate.");
  return {{"/jobs/{jobId}/results",
           {{"parameters", {job}},
            {"get", operation("getResult", "The results of a job", "As the execute request asked for them.", "jobs",
                              Json::array(), all)}}},
          {"/jobs/{jobId}/results/{output}",
           {{"parameters", {job, output}},
            {"get", operation("getOutput", "One output of a job", "The output by itself.", "jobs",
                              Json::array({query_parameter(
                                  "f", text, "The format, where it is to be another than was computed.")}),
                              one)}}}};
}

}  // namespace

Json job_paths() {
  const Json job = path_parameter("jobId", "As the Location of the job says it.");
  const Json events = {{"description", "Server-sent events, one statusInfo each, until the job is over."},
                       {"content", {{"text/event-stream", {{"schema", text}}}}}};
  const Json kept = {{"description", "It is kept for a while, for inputs with this href."},
                     {"headers", {{"Location", {{"description", "Where it is."}, {"schema", text}}}}},
                     {"content", {{"application/json", {{"schema", schema("link")}}}}}};
  Json paths = {
      {"/jobs",
       {{"get", operation("getJobs", "The jobs", "Jobs that fit every condition, the latest first.", "jobs",
                          list_parameters(), found(page_response("The jobs.", schema("jobList"))))}}},
      {"/jobs/{jobId}",
       {{"parameters", {job}},
        {"get", operation("getStatus", "One job", "How far a job is.", "jobs", Json::array({f_parameter()}),
                          found(page_response("The status.", schema("statusInfo")), {404}))},
        {"delete",
         operation("dismiss", "Dismiss a job", "Stops the work and removes what came of it.", "jobs",
                   Json::array({f_parameter()}),
                   responses({{"200", page_response("The job is dismissed.", schema("statusInfo"))}}, {404}))}}},
      {"/jobs/{jobId}/events",
       {{"parameters", {job}},
        {"get", operation("getEvents", "A job as it goes", "The status whenever it changes.", "jobs", Json::array(),
                          responses({{"200", events}}, {404}))}}},
      {"/uploads",
       {{"post", operation("upload", "Keep data for later", "Data for one or more executions that follow.", "data",
                           Json::array({query_parameter("name", text, "The file's name, which may tell its format.")}),
                           responses({{"201", kept}}, {408, 411, 413, 415, 507}))}}}};
  paths["/uploads"]["post"]["requestBody"] = {{"required", true},
                                              {"content", {{"application/octet-stream", {{"schema", binary()}}}}}};
  paths.update(results_paths());
  return paths;
}

Json callbacks() {
  const auto called = [](const char* uri, const char* summary, const char* what) {
    const Json body = {{"required", true}, {"content", {{"application/json", {{"schema", schema(what)}}}}}};
    return Json{{std::string("{$request.body#/subscriber/") + uri + "}",
                 {{"post",
                   {{"operationId", std::string("tell-") + uri},
                    {"summary", summary},
                    {"description",
                     "Sent to hosts that the server allows (--allow-hosts). The end of a job is sent up to "
                     "seven times within a quarter of an hour, and may arrive twice."},
                    {"requestBody", body},
                    {"responses",
                     {{"2XX", {{"description", "It has arrived."}}},
                      {"4XX", {{"description", "It was refused; nothing follows."}}}}}}}}}};
  };
  return {{"success", called("successUri", "The job is done", "results")},
          {"inProgress", called("inProgressUri", "The job goes on", "statusInfo")},
          {"failed", called("failedUri", "The job has failed", "statusInfo")}};
}

}  // namespace terrane::openapi_parts
