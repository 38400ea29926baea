// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/policy.hpp"

#include <limits>

#include "server/http/compression.hpp"
#include "server/http/conditional.hpp"
#include "server/http/header_fields.hpp"

namespace terrane {

namespace {

Reply metrics_page(const Call& call, const Metrics& metrics) {
  const std::string allowed = "GET, HEAD, OPTIONS";
  if (call.method == "OPTIONS") return Reply{204, "", {{"Allow", allowed}}, ""};
  if (call.method != "GET") {
    throw HttpError(405, "method-not-allowed", "This path takes " + allowed + ".", {{"Allow", allowed}});
  }
  return Reply{200, "text/plain; version=0.0.4; charset=utf-8", {{"Cache-Control", "no-store"}}, metrics.text()};
}

/// The coding the body is going to have, "" for none.
std::string coding_of(const Call& call, const Reply& reply) {
  if (asks_for_part(call, reply)) return "";
  // What is packed while it is sent has no length, and HTTP/1.0 knows no other end than that.
  if (call.version == "HTTP/1.0" && !std::holds_alternative<std::string>(reply.body)) return "";
  return wanted_coding(header_value(call, "accept-encoding"));
}

}  // namespace

std::optional<Reply> Policy::answer_early(Call& call) const {
  if (auto reply = cors_.answer_preflight(call)) return reply;  // it comes without a token
  const bool is_open = call.path == "/health" || call.path == "/ready";
  if (tokens_.are_needed() && !is_open) call.user = check_token(tokens_, header_value(call, "authorization"));
  if (call.path == "/metrics") return metrics_page(call, metrics_);
  return std::nullopt;
}

Reply Policy::finish(const Call& call, Reply&& reply) const {
  add_etag(call, reply);
  std::string coding;
  if (is_compressible(reply)) {
    vary_on(reply, "Accept-Encoding");
    coding = coding_of(call, reply);
    if (!coding.empty()) announce_coding(reply, coding);
  }
  reply = apply_conditions(call, std::move(reply));
  if (!coding.empty() && reply_header(reply, "Content-Encoding") == coding) {
    const bool has_chunks = call.version != "HTTP/1.0";
    compress(reply, coding, has_chunks ? std::size_t{1} << 20 : std::numeric_limits<std::size_t>::max());
  }
  cors_.allow(call, reply);
  return std::move(reply);
}

}  // namespace terrane
