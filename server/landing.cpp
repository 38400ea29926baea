// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/operation.hpp"
#include "server/service.hpp"

namespace terrane {

namespace {

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      default: result += c;
    }
  }
  return result;
}

}  // namespace

Reply landing_page(const Call& call) {
  const std::string base = base_url(call);
  const auto link = [&](const std::string& path, const std::string& rel, const std::string& type,
                        const std::string& title) {
    return nlohmann::json{{"href", base + path}, {"rel", rel}, {"type", type}, {"title", title}};
  };
  return json_reply(
      {{"title", "Terrane"},
       {"description",
        "Exact algebra on terrain TINs: merge, add, subtract, volumes, with a certificate for each result."},
       {"version", TERRANE_VERSION},
       {"links",
        {link("/", "self", "application/json", "This page"),
         link("/", "alternate", "text/html", "This page for people"),
         link("/openapi.json", "service-desc", "application/vnd.oai.openapi+json;version=3.1", "The interface"),
         link("/conformance", "http://www.opengis.net/def/rel/ogc/1.0/conformance", "application/json", "Conformance"),
         link("/processes", "http://www.opengis.net/def/rel/ogc/1.0/processes", "application/json",
              "The processes")}}});
}

Reply landing_html(const Call& call) {
  std::string rows;
  for (const Operation& operation : catalogue()) {
    rows += "<tr><td><a href=\"/processes/" + escaped(operation.id) + "\">" + escaped(operation.id) + "</a></td><td>" +
            escaped(operation.title) + "</td></tr>\n";
  }
  Reply reply;
  reply.media_type = "text/html; charset=utf-8";
  reply.body =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Terrane</title>\n"
      "<style>body{font:16px/1.5 sans-serif;max-width:50em;margin:2em auto;padding:0 1em}"
      "td{padding:.1em 1em .1em "
      "0;vertical-align:top}pre{background:#eee;padding:1em;overflow:auto}</style></head><body>\n"
      "<h1>Terrane</h1>\n<p>Exact algebra on terrain TINs. Send tiles, get one exact surface:</p>\n"
      "<pre>curl -fsS -F tiles=@a.tif -F tiles=@b.obj '" +
      base_url(call) + "/processes/merge/execution?f=obj' -o merged.obj</pre>\n<table>\n" + rows +
      "</table>\n<p><a href=\"/openapi.json\">OpenAPI</a> · <a href=\"/processes\">processes</a> · "
      "<a href=\"/conformance\">conformance</a> · <a href=\"/health\">health</a></p>\n</body></html>\n";
  reply.headers.emplace_back("Content-Security-Policy", "default-src 'none'; style-src 'unsafe-inline'");
  return reply;
}

}  // namespace terrane
