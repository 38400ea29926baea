// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/cors.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "server/http/header_fields.hpp"

namespace terrane {

namespace {

constexpr const char* methods = "GET, HEAD, POST, DELETE, OPTIONS";
constexpr const char* request_headers =
    "Accept, Authorization, Content-Encoding, Content-Type, Idempotency-Key, If-Match, If-None-Match, If-Range, "
    "Last-Event-ID, Prefer, Range, X-Request-Id";
constexpr const char* reply_headers =
    "Location, Link, ETag, Retry-After, Content-Disposition, Content-Range, Content-Encoding, Accept-Ranges, "
    "Preference-Applied, Server-Timing, WWW-Authenticate, X-Request-Id, Terrane-Warnings";
constexpr const char* max_age = "7200";  // seconds; Chromium takes no more

/// A scheme and a host, as browsers write them: a slash at the end would never match.
bool is_origin(std::string_view text) {
  const std::size_t host = text.find("://");
  return host != std::string_view::npos && host > 0 && host + 3 < text.size() &&
         text.find_first_of("/ *", host + 3) == std::string_view::npos;
}

}  // namespace

Cors::Cors(std::vector<std::string> origins) : origins_(std::move(origins)) {
  for (const std::string& origin : origins_) {
    if (origin == "*" || is_origin(origin)) continue;
    throw Error(ErrorKind::usage, "bad-origin",
                "'" + origin + "' is no origin; they look like https://maps.example.org, and * means all.");
  }
}

std::optional<Reply> Cors::answer_preflight(const Call& call) const {
  if (call.method != "OPTIONS" || header_value(call, "origin").empty()) return std::nullopt;
  if (header_value(call, "access-control-request-method").empty()) return std::nullopt;
  Reply reply;
  reply.status = 204;
  allow(call, reply);
  if (!reply_header(reply, "Access-Control-Allow-Origin")) return reply;  // the browser reads that as a no
  reply.headers.emplace_back("Access-Control-Allow-Methods", methods);
  reply.headers.emplace_back("Access-Control-Allow-Headers", request_headers);
  reply.headers.emplace_back("Access-Control-Max-Age", max_age);
  return reply;
}

void Cors::allow(const Call& call, Reply& reply) const {
  if (origins_.empty()) return;
  const auto is_listed = [&](std::string_view origin) {
    return std::find(origins_.begin(), origins_.end(), origin) != origins_.end();
  };
  std::string allowed = "*";
  if (!is_listed("*")) {
    vary_on(reply, "Origin");  // also where the answer is a no: a cache must not give it to another page
    allowed = header_value(call, "origin");
    if (allowed.empty() || !is_listed(allowed)) return;
  }
  set_reply_header(reply, "Access-Control-Allow-Origin", allowed);
  set_reply_header(reply, "Access-Control-Expose-Headers", reply_headers);
}

}  // namespace terrane
