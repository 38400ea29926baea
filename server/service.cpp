// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/service.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "ops/errors.hpp"
#include "ops/operation.hpp"

namespace terrane {

namespace {

constexpr std::string_view json_type = "application/json";
constexpr std::string_view openapi_type = "application/vnd.oai.openapi+json;version=3.1";

/// "f" of a resource: json, or html where there is such a page.
enum class Shape { json, html };

Shape shape_wanted(const Call& call, bool has_html, std::string_view media_type) {
  for (const auto& [name, text] : call.query) {
    if (name != "f") throw HttpError(400, "unknown-parameter", "There is no parameter " + name + " here; there is f.");
  }
  if (const auto f = query_value(call, "f")) {
    if (*f == "json") return Shape::json;
    if (*f == "html" && has_html) return Shape::html;
    throw HttpError(400, "unknown-format", "f is " + *f + "; there is json" + (has_html ? " and html." : "."));
  }
  const auto accepted = accepted_media_types(call.accept);
  // A browser names text/html before anything else; whoever takes anything gets JSON.
  const auto rank = [&](std::string_view type) {
    const auto found = std::find(accepted.begin(), accepted.end(), type);
    return found - accepted.begin();
  };
  if (has_html && !accepted.empty() &&
      rank("text/html") < std::min<std::ptrdiff_t>(std::ssize(accepted), rank(json_type))) {
    return Shape::html;
  }
  if (!is_accepted(accepted, json_type) && !is_accepted(accepted, media_type)) {
    throw HttpError(406, "not-acceptable",
                    "This resource is application/json" + std::string(has_html ? " or text/html." : "."));
  }
  return Shape::json;
}

nlohmann::json link(const std::string& href, const std::string& rel, std::string_view type, const std::string& title) {
  return {{"href", href}, {"rel", rel}, {"type", type}, {"title", title}};
}

Reply process_list(const Call& call) {
  nlohmann::json processes = nlohmann::json::array();
  const std::string base = base_url(call);
  for (const Operation& operation : catalogue()) {
    nlohmann::json summary = process_summary(operation);
    summary["links"] = {link(base + "/processes/" + operation.id, "self", json_type, "Description of " + operation.id)};
    processes.push_back(std::move(summary));
  }
  return json_reply(
      {{"processes", processes}, {"links", {link(base + "/processes", "self", json_type, "The processes")}}});
}

Reply process_page(const Call& call, const std::string& id) {
  const Operation& operation = find_operation(id);
  nlohmann::json description = process_description(operation);
  const std::string self = base_url(call) + "/processes/" + id;
  description["links"] = {
      link(self, "self", json_type, "This description"),
      link(self + "/execution", "http://www.opengis.net/def/rel/ogc/1.0/execute", json_type, "Execute")};
  return json_reply(description);
}

/// Plain paths, and whether they have a page for people.
bool is_resource(const std::string& path) {
  return path == "/" || path == "/health" || path == "/ready" || path == "/conformance" || path == "/openapi.json" ||
         path == "/processes" || (path.starts_with("/processes/") && path.find('/', 11) == std::string::npos) ||
         (path.starts_with("/reports/") && path.find('/', 9) == std::string::npos);
}

}  // namespace

std::string base_url(const Call& call) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) || c == '.' || c == '-' || c == ':' || c == '[' || c == ']';
  };
  if (call.host.empty() || call.host.size() > 255 || !std::all_of(call.host.begin(), call.host.end(), plain)) return "";
  return "http://" + call.host;
}

Service::Service(const ServiceLimits& limits)
    : limits_(limits), admission_(limits.slots, limits.line, 4 * limits.max_body), reports_(limits.max_reports) {}

std::optional<std::string> execution_path(std::string_view path) {
  constexpr std::string_view head = "/processes/", tail = "/execution";
  if (!path.starts_with(head) || !path.ends_with(tail) || path.size() <= head.size() + tail.size()) return std::nullopt;
  const std::string_view id = path.substr(head.size(), path.size() - head.size() - tail.size());
  if (id.find('/') != std::string_view::npos) return std::nullopt;
  return std::string(id);
}

std::optional<Reply> Service::answer_header(const Call& call) {
  const auto execution = execution_path(call.path);
  if (!execution && !is_resource(call.path)) {
    throw HttpError(404, "no-such-page", "There is nothing at this path; / lists what there is.");
  }
  const std::string allowed = execution ? "POST, OPTIONS" : "GET, HEAD, OPTIONS";
  if (call.method == "OPTIONS") return Reply{204, "", {{"Allow", allowed}}, ""};
  if (call.method != (execution ? "POST" : "GET")) {
    throw HttpError(405, "method-not-allowed", "This path takes " + allowed + ".", {{"Allow", allowed}});
  }
  if (!execution) return resource(call, call.path);
  find_operation(*execution);
  check_body_header(call);
  return std::nullopt;
}

Reply Service::resource(const Call& call, const std::string& path) {
  if (path == "/") return shape_wanted(call, true, json_type) == Shape::html ? landing_html(call) : landing_page(call);
  shape_wanted(call, false, path == "/openapi.json" ? openapi_type : json_type);
  if (path == "/health") return json_reply({{"status", "ok"}});
  if (path == "/ready") {
    if (!admission_.has_room()) throw Error(ErrorKind::busy, "not-ready", "No place is free at the moment.");
    return json_reply({{"status", "ready"}});
  }
  // Every class of the standard needs its core, which has jobs: nothing is claimed before they are there.
  if (path == "/conformance") return json_reply({{"conformsTo", nlohmann::json::array()}});
  if (path == "/openapi.json") {
    Reply reply = json_reply(openapi());
    const auto accepted = accepted_media_types(call.accept);
    reply.media_type = is_accepted(accepted, openapi_type) ? openapi_type : json_type;
    return reply;
  }
  if (path == "/processes") return process_list(call);
  if (path.starts_with("/processes/")) return process_page(call, path.substr(11));
  const auto report = reports_.get(path.substr(9));
  if (!report)
    throw HttpError(404, "no-such-report", "This report is not there, or no longer; reports are kept for a while.");
  return {200, std::string(json_type), {}, *report};
}

/// Refuses what can be refused before a byte of the body is read.
void Service::check_body_header(const Call& call) const {
  if (call.ambiguous_length) {
    throw HttpError(400, "ambiguous-length", "The length of the body is said twice.");
  }
  const bool chunked = call.transfer_encoding == "chunked";
  if (!call.transfer_encoding.empty() && !chunked) {
    throw HttpError(400, "unknown-transfer-coding", "The only transfer coding understood is chunked.");
  }
  if (!chunked && call.content_length.empty()) {
    throw HttpError(411, "length-required", "Send a Content-Length, or the body in chunks.");
  }
  const std::string& length = call.content_length;
  if (!chunked && (length.size() > 18 || length.find_first_not_of("0123456789") != std::string::npos)) {
    throw HttpError(length.find_first_not_of("0123456789") == std::string::npos ? 413 : 400, "bad-length",
                    "The Content-Length is not a usable number.");
  }
  if (!chunked && std::stoull(length) > limits_.max_body) {
    throw HttpError(413, "body-too-large",
                    "The body is " + length + " bytes; this server takes up to " + std::to_string(limits_.max_body) +
                        " (--max-body).");
  }
  const std::string& coding = call.content_encoding;
  if (!coding.empty() && coding != "identity" && coding != "gzip" && coding != "deflate" && coding != "br") {
    throw HttpError(415, "unknown-content-coding", "The body may be encoded as gzip, deflate or br.");
  }
  const bool is_empty = !chunked && std::stoull(length) == 0;
  const std::string type = media_type(call.content_type);
  if (!is_empty && type != "multipart/form-data" && type != "application/json") {
    throw HttpError(415, "unsupported-body",
                    "The body must be multipart/form-data or application/json, not " +
                        (type.empty() ? "without a type" : header_text(type)) + ".");
  }
}

}  // namespace terrane
