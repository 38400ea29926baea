// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/service.hpp"

#include "core/error.hpp"
#include "ops/operation.hpp"
#include "server/http/unpacking.hpp"
#include "server/pages/html.hpp"
#include "server/pages/pages.hpp"

namespace terrane {

namespace {

constexpr std::string_view json_type = "application/json";

bool is_resource(const std::string& path) {
  return path == "/" || path == "/health" || path == "/ready" || path == "/conformance" || path == "/openapi.json" ||
         path == "/api" || path == "/docs" || path == "/processes" ||
         (path.starts_with("/processes/") && path.find('/', 11) == std::string::npos) ||
         (path.starts_with("/reports/") && path.find('/', 9) == std::string::npos);
}

constexpr int most_checks = 64;  // orders of jobs that wait to be looked into

bool is_postgresql(const std::string& store) {
  return store.starts_with("postgresql:") || store.starts_with("postgres:");
}

}  // namespace

Service::Service(const ServiceLimits& limits, const ServicePlace& place)
    : limits_(limits),
      data_(place.data, is_postgresql(place.store) ? random_id() : "server", !is_postgresql(place.store)),
      admission_(limits.slots, limits.line),
      checks_(limits.checks, most_checks),
      reports_(limits.max_reports),
      workers_(place.worker_command, data_.work()),
      store_(is_postgresql(place.store) ? open_postgresql_store(place.store)
                                        : open_sqlite_store((data_.root() / "jobs.sqlite").string())),
      outbound_(place.allow_hosts),
      references_(data_, *store_, outbound_, limits.max_body),
      jobs_(*store_, data_, workers_, admission_, references_, outbound_, limits.jobs, random_id(),
            !is_postgresql(place.store)) {}

void Service::close() {
  closing_ = true;
  outbound_.stop();
  admission_.close();
  checks_.close();
}

void Service::cancel() {
  admission_.cancel();
  checks_.cancel();
  jobs_.stop();
}

std::optional<std::string> execution_path(std::string_view path) {
  constexpr std::string_view head = "/processes/", tail = "/execution";
  if (!path.starts_with(head) || !path.ends_with(tail) || path.size() <= head.size() + tail.size()) return std::nullopt;
  const std::string_view id = path.substr(head.size(), path.size() - head.size() - tail.size());
  if (id.find('/') != std::string_view::npos) return std::nullopt;
  return std::string(id);
}

void refuse_path() { throw HttpError(404, "no-such-page", "There is nothing at this path; / lists what there is."); }

std::optional<Reply> Service::answer_header(const Call& call) {
  if (call.path == "/jobs" || call.path.starts_with("/jobs/")) return answer_jobs(call);
  const auto execution = execution_path(call.path);
  const bool takes_body = execution || call.path == "/uploads";
  if (!takes_body && !is_resource(call.path)) refuse_path();
  const std::string allowed = takes_body ? "POST, OPTIONS" : "GET, HEAD, OPTIONS";
  if (call.method == "OPTIONS") return Reply{204, "", {{"Allow", allowed}}, ""};
  if (call.method != (takes_body ? "POST" : "GET")) {
    throw HttpError(405, "method-not-allowed", "This path takes " + allowed + ".", {{"Allow", allowed}});
  }
  if (!takes_body) return resource(call, call.path);
  if (execution) find_operation(*execution);
  check_body_header(call);
  return std::nullopt;
}

Reply Service::resource(const Call& call, const std::string& path) {
  if (auto page = describe_service(call)) return std::move(*page);
  const Shape shape = shape_wanted(call);
  if (path == "/health") return shaped(shape, "Health", {{"status", "ok"}}, value_html);
  if (path == "/ready") {
    if (!admission_.has_room()) throw Error(ErrorKind::busy, "not-ready", "No place is free at the moment.");
    return shaped(shape, "Readiness", {{"status", "ready"}}, value_html);
  }
  const auto report = reports_.get(path.substr(9));
  if (!report)
    throw HttpError(404, "no-such-report", "This report is not there, or no longer; reports are kept for a while.");
  if (shape == Shape::html) return shaped(shape, "Certificate", nlohmann::json::parse(*report), value_html);
  return {200, std::string(json_type), {}, *report};
}

/// Refuses what can be refused before a byte of the body is read.
void Service::check_body_header(const Call& call) const {
  const bool chunked = !call.transfer_encoding.empty();  // the front lets no other coding pass
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
  unpacker(call.content_encoding);  // throws where there is none
  if (call.path == "/uploads") {
    require_known_parameters(call, {"name"});
    return require_media_type(call.content_type);
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
