// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/pages/pages.hpp"

#include <algorithm>
#include <charconv>

#include "ops/openapi/describe.hpp"
#include "ops/operation.hpp"
#include "server/http/header_fields.hpp"
#include "server/pages/html.hpp"

namespace terrane {

namespace {

using Json = nlohmann::json;

constexpr const char* json_type = "application/json";
constexpr const char* html_type = "text/html";
constexpr const char* openapi_30_type = "application/vnd.oai.openapi+json;version=3.0";
constexpr const char* openapi_31_type = "application/vnd.oai.openapi+json;version=3.1";
constexpr std::size_t most_processes = 10000, usual_processes = 1000;

const std::string relations = "http://www.opengis.net/def/rel/ogc/1.0/";

std::string encoded(std::string_view text) {
  std::string result;
  for (const unsigned char c : text) {
    if (std::isalnum(c) || c == '-' || c == '.' || c == '_' || c == '~')
      result += static_cast<char>(c);
    else
      result += '%', result += "0123456789ABCDEF"[c >> 4], result += "0123456789ABCDEF"[c & 15];
  }
  return result;
}

std::size_t number_wanted(const Call& call, std::string_view name, std::size_t usual, std::size_t least) {
  const auto text = query_value(call, name);
  if (!text) return usual;
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
  if (error != std::errc{} || end != text->data() + text->size() || value < least)
    throw HttpError(400, "bad-parameter",
                    std::string(name) + " takes a whole number from " + std::to_string(least) + ".");
  return value;
}

Reply landing(const Call& call) {
  const Shape shape = shape_wanted(call);
  const std::string base = base_url(call);
  Json links = shape_links(call, shape);
  links.push_back(link(base + "/api", "service-desc", openapi_30_type, "The interface, OpenAPI 3.0"));
  links.push_back(link(base + "/openapi.json", "service-desc", openapi_31_type, "The interface, OpenAPI 3.1"));
  links.push_back(link(base + "/docs", "service-doc", html_type, "The interface to read"));
  links.push_back(link(base + "/conformance", relations + "conformance", json_type, "What is conformed to"));
  links.push_back(link(base + "/processes", relations + "processes", json_type, "The operations"));
  links.push_back(link(base + "/jobs", relations + "job-list", json_type, "The jobs"));
  const std::string sentence =
      "Exact algebra on terrain TINs: merge, add, subtract, volumes, with a certificate for each result.";
  if (shape == Shape::json)
    return json_reply(
        {{"title", "Terrane"}, {"description", sentence}, {"version", TERRANE_VERSION}, {"links", links}});
  std::string rows;
  for (const Operation& operation : catalogue())
    rows += "<tr><td>" + anchor("/processes/" + operation.id, operation.id) + "</td><td>" + escaped(operation.title) +
            "</td></tr>\n";
  return html_reply("Terrane", "<p>" + sentence +
                                   " Version " TERRANE_VERSION
                                   ".</p>\n<p>Send tiles, get one exact surface:</p>\n"
                                   "<pre>curl -fsS -F tiles=@a.tif -F tiles=@b.obj '" +
                                   base + "/processes/merge/execution?f=obj' -o merged.obj</pre>\n<table>\n" + rows +
                                   "</table>\n<h2>Links</h2>\n" + links_html(links));
}

Reply conformance(const Call& call) {
  const Shape shape = shape_wanted(call);
  Json classes = Json::array();
  for (const char* name :
       {"core", "ogc-process-description", "json", "html", "oas30", "job-list", "callback", "dismiss"})
    classes.push_back(std::string("http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/") + name);
  const Json value = {{"conformsTo", classes}, {"links", shape_links(call, shape)}};
  return shaped(shape, "Conformance", value, conformance_html);
}

Reply processes(const Call& call) {
  const Shape shape = shape_wanted(call, {"limit", "offset"});
  const std::size_t limit = std::min(most_processes, number_wanted(call, "limit", usual_processes, 1));
  const std::size_t offset = number_wanted(call, "offset", 0, 0), all = catalogue().size();
  const std::string base = base_url(call);
  Json list = Json::array();
  for (std::size_t i = offset; i < all && list.size() < limit; ++i) {
    const Operation& operation = catalogue()[i];
    Json summary = process_summary(operation);
    const std::string self = base + "/processes/" + operation.id;
    summary["links"] = {link(self, "self", json_type, "Description of " + operation.id),
                        link(self + "?f=html", "alternate", html_type, "Description of " + operation.id + " to read")};
    list.push_back(std::move(summary));
  }
  Json links = shape_links(call, shape);
  if (offset < all && all - offset > limit)
    links.push_back(link(address_with(call, {{"offset", std::to_string(offset + limit)}}), "next",
                         shape == Shape::json ? json_type : html_type, "More operations"));
  if (offset > 0)
    links.push_back(link(address_with(call, {{"offset", std::to_string(offset - std::min(offset, limit))}}), "prev",
                         shape == Shape::json ? json_type : html_type, "The operations before"));
  const Json value = {{"processes", list}, {"links", links}};
  return shaped(shape, "The operations", value, process_list_html);
}

Reply process(const Call& call, const std::string& id) {
  const Operation& operation = find_operation(id);
  const Shape shape = shape_wanted(call);
  Json description = process_description(operation);
  description["links"] = shape_links(call, shape);
  description["links"].push_back(
      link(base_url(call) + call.path + "/execution", relations + "execute", json_type, "Execute"));
  if (shape == Shape::json) return json_reply(description);
  return html_reply(operation.id, process_html(description, example_command(operation, base_url(call))));
}

// The interface is the same for everybody, and making it takes longer than most work does: it is made once.
Reply docs() {
  static const Reply reply = html_reply("The interface", docs_html(openapi_30()));
  return reply;
}

Reply interface(const Call& call, const char* media_type, Reply reply) {
  if (shape_wanted(call, {}, media_type) == Shape::html) return docs();
  reply.media_type = is_accepted(accepted_media_types(call.accept), media_type) ? media_type : json_type;
  return reply;
}

std::optional<Reply> description(const Call& call) {
  const std::string& path = call.path;
  if (path == "/") return landing(call);
  if (path == "/conformance") return conformance(call);
  if (path == "/processes") return processes(call);
  if (path == "/openapi.json") {
    static const Reply reply = json_reply(openapi());
    return interface(call, openapi_31_type, reply);
  }
  if (path == "/api") {
    static const Reply reply = json_reply(openapi_30());
    return interface(call, openapi_30_type, reply);
  }
  if (path == "/docs") {
    if (shape_wanted(call, {}, html_type) == Shape::json && query_value(call, "f"))
      throw HttpError(400, "unknown-format", "This is a page; the same as JSON is at /api and /openapi.json.");
    return docs();
  }
  if (path.starts_with("/processes/") && path.find('/', 11) == std::string::npos) return process(call, path.substr(11));
  return std::nullopt;
}

}  // namespace

void require_known_parameters(const Call& call, const std::vector<std::string_view>& known,
                              const std::string& instead) {
  for (const auto& [name, text] : call.query) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    std::string list;
    for (const std::string_view word : known) list.append(list.empty() ? "; there is " : ", ").append(word);
    throw HttpError(400, "unknown-parameter",
                    "There is no parameter " + header_text(name) + " here" + list + instead + ".");
  }
}

Shape shape_wanted(const Call& call, std::vector<std::string_view> others, std::string_view media_type) {
  others.insert(others.begin(), "f");
  require_known_parameters(call, others);
  if (const auto f = query_value(call, "f")) {
    if (*f == "json") return Shape::json;
    if (*f == "html") return Shape::html;
    throw HttpError(400, "unknown-format", "f is " + header_text(*f) + "; there is json and html.");
  }
  const auto accepted = accepted_media_types(call.accept);
  const auto rank = [&](std::string_view type) {
    for (std::size_t i = 0; i < accepted.size(); ++i)
      if (is_accepted({accepted[i]}, type)) return i;
    return accepted.size();
  };
  const std::size_t as_json = std::min(rank(json_type), rank(media_type)), as_html = rank(html_type);
  if (accepted.empty() || as_json < std::min(as_html, accepted.size())) return Shape::json;
  if (as_html == accepted.size())
    throw HttpError(406, "not-acceptable", "This resource is application/json or text/html.");
  return as_json == as_html ? Shape::json : Shape::html;
}

Json link(const std::string& href, const std::string& rel, const std::string& type, const std::string& title) {
  return {{"href", href}, {"rel", rel}, {"type", type}, {"title", title}};
}

std::string address_with(const Call& call, const TextPairs& changed) {
  std::string query;
  const auto add = [&](const std::string& name, const std::string& text) {
    if (!text.empty()) query += (query.empty() ? "?" : "&") + encoded(name) + "=" + encoded(text);
  };
  for (const auto& [name, text] : call.query)
    if (std::none_of(changed.begin(), changed.end(), [&name = name](const auto& c) { return c.first == name; }))
      add(name, text);
  for (const auto& [name, text] : changed) add(name, text);
  return base_url(call) + call.path + query;
}

Json shape_links(const Call& call, Shape shape) {
  const std::string plain = address_with(call, {{"f", "json"}}), page = address_with(call, {{"f", "html"}});
  if (shape == Shape::html)
    return {link(page, "self", html_type, "This page"), link(plain, "alternate", json_type, "This as JSON")};
  return {link(plain, "self", json_type, "This document"),
          link(page, "alternate", html_type, "This as a page to read")};
}

Reply shaped(Shape shape, const std::string& title, const Json& value, std::string (*page)(const Json&)) {
  Reply reply = shape == Shape::json ? json_reply(value) : html_reply(title, page(value));
  vary_on(reply, "Accept");
  return reply;
}

std::optional<Reply> describe_service(const Call& call) {
  auto reply = description(call);
  if (reply) vary_on(*reply, "Accept");
  return reply;
}

}  // namespace terrane
