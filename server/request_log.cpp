// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/request_log.hpp"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <random>

namespace terrane {

namespace {

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

void log_request(const LogLine& line) {
  nlohmann::ordered_json value = {
      {"time", utc_now()},       {"request_id", line.request_id},     {"client", line.client},
      {"method", line.method},   {"path", line.path.substr(0, 1024)}, {"status", line.status},
      {"seconds", line.seconds}, {"bytes_in", line.bytes_in},         {"bytes_out", line.bytes_out}};
  if (!line.user.empty()) value["user"] = line.user;
  if (!line.failure.empty()) value["failure"] = line.failure;
  write_line(value);
}

void log_event(std::string_view level, std::string_view message, const nlohmann::ordered_json& details) {
  nlohmann::ordered_json value = {{"time", utc_now()}, {"request_id", ""}, {"level", level}, {"message", message}};
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
