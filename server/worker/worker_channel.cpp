// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/worker/worker_channel.hpp"

#include <poll.h>
#include <unistd.h>

#include <cerrno>

#include "ops/errors.hpp"
#include "ops/json_value.hpp"
#include "server/http/message.hpp"
#include "server/requests/json_slices.hpp"

namespace terrane {

namespace {

// Whatever a worker sends is short; one that was taken over by its input might send without end.
constexpr std::size_t longest_line = 1 << 20;

}  // namespace

bool WorkerChannel::send(const nlohmann::json& message) const {
  const std::string line = json_text(message) + "\n";
  for (std::size_t at = 0; at < line.size();) {
    const ssize_t n = write(socket_, line.data() + at, line.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    at += static_cast<std::size_t>(n);
  }
  return true;
}

std::optional<nlohmann::json> WorkerChannel::receive(int milliseconds) {
  while (true) {
    if (const auto end = buffer_.find('\n'); end != std::string::npos) {
      const std::string line = buffer_.substr(0, end);
      buffer_.erase(0, end + 1);
      try {  // no deeper than anything else that comes from outside
        auto message = parse_json(line, "a message of a worker");
        if (message.is_object()) return message;
      } catch (const std::exception&) {
      }
      over_ = true;
    }
    if (over_ || buffer_.size() > longest_line) return over_ = true, std::nullopt;
    pollfd wait{socket_, POLLIN, 0};
    const int ready = poll(&wait, 1, milliseconds);
    if (ready == 0 || (ready < 0 && errno == EINTR)) return std::nullopt;
    char piece[4096];
    const ssize_t n = read(socket_, piece, sizeof piece);
    if (n <= 0) return over_ = true, std::nullopt;
    buffer_.append(piece, static_cast<std::size_t>(n));
  }
}

nlohmann::json failure_message(const std::exception& exception) {
  if (const auto* http = dynamic_cast<const HttpError*>(&exception))
    return {{"status", http->status}, {"code", http->code}, {"message", http->what()}, {"headers", http->headers}};
  const Error error = as_error(exception);
  return {{"kind", static_cast<int>(error.kind)}, {"code", error.code}, {"message", error.what()}};
}

void throw_failure(const nlohmann::json& message) {
  const std::string code = message.value("code", ""), text = message.value("message", "");
  if (message.contains("status"))
    throw HttpError(message.value("status", 500), code, text, message.value("headers", TextPairs{}));
  const int kind = message.value("kind", static_cast<int>(ErrorKind::internal));
  throw Error(
      kind < 0 || kind > static_cast<int>(ErrorKind::internal) ? ErrorKind::internal : static_cast<ErrorKind>(kind),
      code, text);
}

}  // namespace terrane
