// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/refusal.hpp"

#include "server/http/message.hpp"
#include "server/request_log.hpp"

namespace terrane {

std::string refusal(const Connection& connection, const std::exception& why) {
  const Reply reply = problem_reply(why);
  const auto& request = connection.request;
  LogLine line;
  line.request_id = request_id(request ? request->head.value("x-request-id") : "");
  line.client = connection.address();
  line.status = reply.status;
  line.bytes_out = static_cast<std::size_t>(*reply.size());
  if (request) {
    line.method = request->head.method;
    line.path = request->head.target.substr(0, request->head.target.find('?'));
    line.bytes_in = static_cast<std::size_t>(request->body.size());
    line.seconds = std::chrono::duration<double>(Incoming::Clock::now() - request->start).count();
  }
  if (reply.status >= 500) line.failure = why.what();
  log_request(line);

  std::string text = "HTTP/1.1 " + std::to_string(reply.status) + " " + std::string(status_title(reply.status));
  const auto add = [&](const std::string& name, const std::string& value) { text += "\r\n" + name + ": " + value; };
  for (const auto& [name, value] : reply.headers) add(name, value);
  add("Content-Type", reply.media_type);
  add("Content-Length", std::to_string(*reply.size()));
  add("Connection", "close");
  add("X-Request-Id", line.request_id);
  add("X-Content-Type-Options", "nosniff");
  return text + "\r\n\r\n" + (request && request->head.method == "HEAD" ? "" : std::get<std::string>(reply.body));
}

}  // namespace terrane
