// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

// One JSON line per request and event on standard error, and the id that ties it to the client's own records.
namespace terrane {

/// How much is said: what is at least so grave. Requests are info, warnings when they were answered with 503 or 507,
/// errors with any other 5xx.
enum class LogLevel { info, warning, error };
std::string_view word(LogLevel level);
std::optional<LogLevel> log_level(std::string_view word);
/// DEFAULT info. Of the process, as its standard error is.
void set_log_level(LogLevel least);

struct LogLine {
  std::string request_id, client, method, path;
  int status = 0;
  double seconds = 0;
  std::size_t bytes_in = 0, bytes_out = 0;
  std::string failure;  // the cause of an answer from 500 on
  std::string user;     // the owner of the token
};

/// Lines of different threads never mix. The query is not logged: it may hold data.
void log_request(const LogLine& line);

/// A line about something that belongs to no request, with members beside the message. Like every line it has a
/// request_id, an empty one.
void log_event(LogLevel level, std::string_view message,
               const nlohmann::ordered_json& details = nlohmann::ordered_json::object());

/// The client's id when it is 1 to 128 letters, digits, '.', '_', '-'; else a new one of 32 hexadecimal digits.
std::string request_id(std::string_view from_client);

}  // namespace terrane
