// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/request_log.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <random>

namespace terrane {

namespace {

constexpr std::array<std::string_view, 3> level_words = {"info", "warning", "error"};
std::atomic<LogLevel> least_level = LogLevel::info;

std::string utc_now() {
  const auto now = std::chrono::system_clock::now();
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  const auto milliseconds =
      std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count() % 1000;
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  char date[32], text[48];
  std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%S", &parts);
  std::snprintf(text, sizeof text, "%s.%03dZ", date, static_cast<int>(milliseconds));
  return text;
}

void write_line(const nlohmann::ordered_json& value) {
  const std::string text = value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + "\n";
  // One call: the stream's lock keeps the line whole.
  std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace

std::string_view word(LogLevel level) { return level_words.at(static_cast<std::size_t>(level)); }

std::optional<LogLevel> log_level(std::string_view word) {
  const auto found = std::find(level_words.begin(), level_words.end(), word);
  if (found == level_words.end()) return std::nullopt;
  return static_cast<LogLevel>(found - level_words.begin());
}

void set_log_level(LogLevel least) { least_level = least; }

void log_request(const LogLine& line) {
  const LogLevel level = line.status < 500                          ? LogLevel::info
                         : line.status == 503 || line.status == 507 ? LogLevel::warning
                                                                    : LogLevel::error;
  if (level < least_level) return;
  nlohmann::ordered_json value = {{"time", utc_now()},         {"request_id", line.request_id},
                                  {"level", word(level)},      {"client", line.client},
                                  {"method", line.method},     {"path", line.path.substr(0, 1024)},
                                  {"status", line.status},     {"seconds", line.seconds},
                                  {"bytes_in", line.bytes_in}, {"bytes_out", line.bytes_out}};
  if (!line.user.empty()) value["user"] = line.user;
  if (!line.failure.empty()) value["failure"] = line.failure;
  write_line(value);
}

void log_event(LogLevel level, std::string_view message, const nlohmann::ordered_json& details) {
  if (level < least_level) return;
  nlohmann::ordered_json value = {
      {"time", utc_now()}, {"request_id", ""}, {"level", word(level)}, {"message", message}};
  value.update(details);
  write_line(value);
}

std::string request_id(std::string_view from_client) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) || c == '.' || c == '_' || c == '-'; };
  if (!from_client.empty() && from_client.size() <= 128 && std::all_of(from_client.begin(), from_client.end(), plain)) {
    return std::string(from_client);
  }
  thread_local std::mt19937_64 random{std::random_device{}()};
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(random()),
                static_cast<unsigned long long>(random()));
  return text;
}

}  // namespace terrane
