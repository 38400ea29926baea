// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/pages/html.hpp"

// The interface as a page to read, made from its OpenAPI document.
namespace terrane {

namespace {

using Json = nlohmann::json;

std::string text(const Json& object, const char* name) { return object.value(name, std::string()); }

std::string pre(const Json& value) { return "<pre>" + escaped(value.dump(2)) + "</pre>"; }

/// "#/components/responses/busy" → that response.
const Json& resolved(const Json& document, const Json& value) {
  const auto reference = value.find("$ref");
  if (reference == value.end()) return value;
  return document.at(Json::json_pointer(reference->get<std::string>().substr(1)));
}

std::string parameter_rows(const Json& list) {
  std::string rows;
  for (const Json& p : list)
    rows += "<tr><th>" + escaped(text(p, "name")) + "</th><td>" + escaped(text(p, "in")) +
            (p.value("required", false) ? ", required" : "") + "</td><td><code>" + escaped(p.at("schema").dump()) +
            "</code></td><td>" + escaped(text(p, "description")) + "</td></tr>\n";
  return rows;
}

std::string responses_html(const Json& document, const Json& responses) {
  std::string rows;
  for (const auto& [status, given] : responses.items()) {
    const Json& response = resolved(document, given);
    std::string types;
    const Json content = response.value("content", Json::object());
    for (const auto& item : content.items()) types += (types.empty() ? "" : ", ") + item.key();
    rows += "<tr><th>" + escaped(status) + "</th><td>" + escaped(text(response, "description")) + "</td><td>" +
            escaped(types) + "</td></tr>\n";
  }
  return "<table>\n" + rows + "</table>\n";
}

std::string operation_html(const Json& document, const std::string& method, const std::string& path,
                           const Json& operation, const Json& shared) {
  std::string name = method;
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string page = "<h3 id=\"" + escaped(text(operation, "operationId")) + "\"><code>" + name + " " + escaped(path) +
                     "</code></h3>\n<p><b>" + escaped(text(operation, "summary")) + ".</b> " +
                     escaped(text(operation, "description")) + "</p>\n";
  const std::string parameters = parameter_rows(shared) + parameter_rows(operation.value("parameters", Json::array()));
  if (!parameters.empty()) page += "<table>\n" + parameters + "</table>\n";
  if (const auto body = operation.find("requestBody"); body != operation.end())
    for (const auto& [type, content] : body->at("content").items())
      page += "<details><summary>" + escaped(type) + "</summary>" + pre(content) + "</details>\n";
  return page + "<details><summary>answers</summary>" + responses_html(document, operation.at("responses")) +
         "</details>\n";
}

}  // namespace

std::string docs_html(const Json& document) {
  std::string index, page;
  for (const Json& tag : document.at("tags")) {
    const std::string name = text(tag, "name");
    page += "<h2>" + escaped(text(tag, "description")) + "</h2>\n";
    for (const auto& [path, methods] : document.at("paths").items())
      for (const auto& [method, operation] : methods.items()) {
        if (!operation.is_object() || operation.at("tags").front() != name) continue;
        index += "<li>" + anchor("#" + text(operation, "operationId"), path) + ": " +
                 escaped(text(operation, "summary")) + "</li>\n";
        page += operation_html(document, method, path, operation, methods.value("parameters", Json::array()));
      }
  }
  std::string schemas;
  for (const auto& [name, schema] : document.at("components").at("schemas").items())
    schemas += "<h3>" + escaped(name) + "</h3>\n" + pre(schema);
  return "<p>" + escaped(text(document.at("info"), "description")) + " Version " +
         escaped(text(document.at("info"), "version")) +
         ". For programs: <a href=\"/openapi.json\">OpenAPI 3.1</a>, <a href=\"/api\">OpenAPI 3.0</a>.</p>\n<ul>\n" +
         index + "</ul>\n" + page + "<h2>Schemas</h2>\n" + schemas;
}

}  // namespace terrane
