// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <exception>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

// How the service and its workers talk: lines of JSON over a socket.
namespace terrane {

class WorkerChannel {
 public:
  /// Does not own the socket.
  explicit WorkerChannel(int socket) : socket_(socket) {}

  /// False when the other side is gone.
  bool send(const nlohmann::json& message) const;
  /// The next line; waits `milliseconds` at most, -1 for as long as it takes. Nothing when none came or the other side
  /// is gone; then is_over() tells which.
  std::optional<nlohmann::json> receive(int milliseconds);
  bool is_over() const { return over_; }

 private:
  int socket_;
  std::string buffer_;
  bool over_ = false;
};

/// An Error or HttpError as a message, and thrown again on the other side.
nlohmann::json failure_message(const std::exception& exception);
[[noreturn]] void throw_failure(const nlohmann::json& message);

}  // namespace terrane
