// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/pages/html.hpp"

#include "ops/json_value.hpp"

namespace terrane {

namespace {

using Json = nlohmann::json;

bool is_address(const std::string& text) { return text.starts_with("http://") || text.starts_with("https://"); }

std::string text_of(const Json& value) { return value.is_string() ? value.get<std::string>() : json_text(value); }

std::string member(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found == object.end() || found->is_null() ? "" : text_of(*found);
}

std::string joined(const Json& words) {
  std::string text;
  for (const Json& word : words) text += (text.empty() ? "" : ", ") + text_of(word);
  return text;
}

/// What a schema asks for, in a few words.
std::string words_of(const Json& schema) {
  if (const auto kinds = schema.find("oneOf"); kinds != schema.end() && !schema.contains("type")) {
    std::string text;
    for (const Json& kind : *kinds) text += (text.empty() ? "" : " or ") + words_of(kind);
    return text;
  }
  std::string text = member(schema, "type");
  if (const auto words = schema.find("enum"); words != schema.end()) text = joined(*words);
  if (schema.contains("contentMediaType")) text = member(schema, "contentMediaType");
  if (schema.contains("items")) text += " of " + words_of(schema["items"]);
  if (schema.contains("minimum")) text += ", from " + member(schema, "minimum");
  if (schema.contains("maximum")) text += " up to " + member(schema, "maximum");
  return text;
}

std::string schema_cell(const Json& schema) {
  return "<td>" + escaped(words_of(schema)) + "<details><summary>schema</summary><pre>" + escaped(schema.dump(2)) +
         "</pre></details></td>";
}

std::string cell(const std::string& text) { return "<td>" + escaped(text) + "</td>"; }

std::string occurs(const Json& input) {
  const std::string least = member(input, "minOccurs"), most = member(input, "maxOccurs");
  return least == most ? least : least + " to " + most;
}

std::string summary_facts(const Json& process) {
  return "<p>Version " + escaped(member(process, "version")) + " · " +
         escaped(joined(process.value("jobControlOptions", Json::array()))) + " · transmitted by " +
         escaped(joined(process.value("outputTransmission", Json::array()))) + "</p>\n";
}

constexpr const char* style =
    "body{font:16px/1.5 sans-serif;max-width:64em;margin:2em auto;padding:0 1em;color:#222;background:#fff}"
    "table{border-collapse:collapse;margin:1em 0}td,th{padding:.25em 1em .25em 0;vertical-align:top;text-align:left;"
    "border-bottom:1px solid #ddd}pre{background:#f2f2f2;padding:1em;overflow:auto}summary{color:#666;cursor:pointer}"
    "h2{margin-top:2em}h3{margin:2em 0 .5em}code{background:#f2f2f2}";

/// What a description says beside the standard's own members: names and values.
std::string additional_html(const Json& description) {
  if (!description.contains("additionalParameters")) return "";
  const Json& additional = description["additionalParameters"];
  std::string rows;
  for (const Json& parameter : additional.at("parameters"))
    rows += "<tr><th>" + escaped(member(parameter, "name")) + "</th>" + cell(parameter.at("value").dump()) + "</tr>\n";
  return "<h2>" + escaped(member(additional, "title")) + "</h2>\n<table>\n" + rows + "</table>\n";
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string anchor(const std::string& href, const std::string& text) {
  // Some of what is shown comes from clients: nothing but plain addresses becomes a link.
  if (!is_address(href) && !href.starts_with("/") && !href.starts_with("#")) return escaped(text);
  return "<a href=\"" + escaped(href) + "\">" + escaped(text) + "</a>";
}

std::string value_html(const Json& value) {
  if (value.is_object()) {
    std::string rows;
    for (const auto& [name, inner] : value.items()) {
      const bool is_link = name == "href" && inner.is_string();
      const bool is_links = name == "links" && inner.is_array();
      rows += "<tr><th>" + escaped(name) + "</th><td>" +
              (is_link    ? anchor(inner, inner)
               : is_links ? links_html(inner)
                          : value_html(inner)) +
              "</td></tr>\n";
    }
    return "<table>\n" + rows + "</table>\n";
  }
  if (value.is_array()) {
    std::string items;
    for (const Json& element : value) items += "<li>" + value_html(element) + "</li>\n";
    return "<ul>\n" + items + "</ul>\n";
  }
  const std::string text = text_of(value);
  return value.is_string() && is_address(text) ? anchor(text, text) : escaped(text);
}

std::string links_html(const Json& links) {
  std::string items;
  for (const Json& link : links) {
    const std::string href = member(link, "href"), title = member(link, "title"), type = member(link, "type");
    items += "<li>" + anchor(href, title.empty() ? href : title) + " (" + escaped(member(link, "rel")) +
             (type.empty() ? "" : ", " + escaped(type)) + ")</li>\n";
  }
  return "<ul>\n" + items + "</ul>\n";
}

Reply html_reply(const std::string& title, const std::string& body) {
  Reply reply;
  reply.media_type = "text/html; charset=utf-8";
  reply.headers.emplace_back("Content-Security-Policy",
                             "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'; "
                             "frame-ancestors 'none'");
  reply.body = "<!doctype html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><title>" + escaped(title) +
               "</title>\n<style>" + style + "</style></head>\n<body>\n<p><a href=\"/\">Terrane</a></p>\n<h1>" +
               escaped(title) + "</h1>\n" + body + "</body>\n</html>\n";
  return reply;
}

std::string conformance_html(const Json& classes) {
  return "<p>This service conforms to</p>\n" + value_html(classes.at("conformsTo")) + "<h2>Links</h2>\n" +
         links_html(classes.at("links"));
}

std::string process_list_html(const Json& list) {
  std::string text;
  for (const Json& process : list.at("processes"))
    text += "<h2>" + anchor("/processes/" + member(process, "id") + "?f=html", member(process, "id")) +
            "</h2>\n<p><b>" + escaped(member(process, "title")) + ".</b> " + escaped(member(process, "description")) +
            "</p>\n" + summary_facts(process) + links_html(process.value("links", Json::array()));
  return text + "<h2>Links</h2>\n" + links_html(list.at("links"));
}

std::string process_html(const Json& description, const std::string& example) {
  std::string inputs, outputs;
  for (const auto& [name, input] : description.at("inputs").items())
    inputs += "<tr><th>" + escaped(name) + "</th>" + cell(occurs(input)) + schema_cell(input.at("schema")) +
              cell(member(input.at("schema"), "default")) + "<td><b>" + escaped(member(input, "title")) + ".</b> " +
              escaped(member(input, "description")) + "</td></tr>\n";
  for (const auto& [name, output] : description.at("outputs").items())
    outputs += "<tr><th>" + escaped(name) + "</th>" + schema_cell(output.at("schema")) + "<td><b>" +
               escaped(member(output, "title")) + ".</b> " + escaped(member(output, "description")) + "</td></tr>\n";
  return "<p><b>" + escaped(member(description, "title")) + ".</b> " + escaped(member(description, "description")) +
         "</p>\n" + summary_facts(description) + "<pre>" + escaped(example) +
         "</pre>\n<h2>Inputs</h2>\n<table>\n<tr><th></th><th>how "
         "often</th><th>takes</th><th>default</th><th></th></tr>\n" +
         inputs + "</table>\n<h2>Outputs</h2>\n<table>\n" + outputs + "</table>\n" + additional_html(description) +
         "<h2>Links</h2>\n" + links_html(description.at("links"));
}

std::string job_list_html(const Json& job_list) {
  const auto columns = {"type",    "processID", "status",  "progress", "message",
                        "created", "started",   "updated", "finished", "expires"};
  std::string head = "<th>jobID</th>", rows;
  for (const char* name : columns) head.append("<th>").append(name).append("</th>");
  for (const Json& job : job_list.at("jobs")) {
    const std::string id = member(job, "jobID");
    rows += "<tr><td>" + anchor("/jobs/" + id + "?f=html", id) + "</td>";
    for (const char* name : columns) rows += cell(member(job, name));
    rows += "<td>" + links_html(job.value("links", Json::array())) + "</td></tr>\n";
  }
  std::string facts;
  if (job_list.contains("numberMatched"))
    facts = "<p>" + member(job_list, "numberReturned") + " of " + member(job_list, "numberMatched") + "</p>\n";
  return facts + "<table>\n<tr>" + head + "<th>links</th></tr>\n" + rows + "</table>\n<h2>Links</h2>\n" +
         links_html(job_list.at("links"));
}

std::string job_html(const Json& status_info) { return value_html(status_info); }

}  // namespace terrane
