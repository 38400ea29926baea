// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/metrics.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>

#include <sys/resource.h>
#include <unistd.h>

#include "ops/operation.hpp"

namespace terrane {

namespace {

constexpr std::array templates = {"/",
                                  "/api",
                                  "/conformance",
                                  "/docs",
                                  "/health",
                                  "/jobs",
                                  "/jobs/{id}",
                                  "/jobs/{id}/events",
                                  "/jobs/{id}/results",
                                  "/jobs/{id}/results/{output}",
                                  "/metrics",
                                  "/openapi.json",
                                  "/processes",
                                  "/processes/{id}",
                                  "/processes/{id}/execution",
                                  "/ready",
                                  "/reports/{id}",
                                  "/uploads",
                                  "/uploads/{id}"};

std::string_view take_segment(std::string_view& path) {
  path.remove_prefix(1);
  const std::size_t end = std::min(path.find('/'), path.size());
  const std::string_view segment = path.substr(0, end);
  path.remove_prefix(end);
  return segment;
}

bool fits(std::string_view path, std::string_view pattern) {
  while (path.starts_with('/') && pattern.starts_with('/')) {
    const std::string_view segment = take_segment(path), wanted = take_segment(pattern);
    if (wanted.starts_with('{') ? segment.empty() : segment != wanted) return false;
  }
  return path.empty() && pattern.empty();
}

/// One of ours, so that it outlives the request.
std::string_view known_method(std::string_view method) {
  for (const std::string_view known : {"GET", "HEAD", "POST", "PUT", "DELETE", "OPTIONS", "PATCH"})
    if (method == known) return known;
  return "other";
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.15g", value);
  return text;
}

void header(std::string& out, const std::string& name, const char* type, const std::string& help) {
  out += "# HELP " + name + " " + help + "\n# TYPE " + name + " " + type + "\n";
}

void single(std::string& out, const std::string& name, const char* type, const std::string& help, double value) {
  header(out, name, type, help);
  out += name + " " + number(value) + "\n";
}

double resident_bytes() {
  std::ifstream file("/proc/self/statm");
  double pages = 0, resident = 0;
  file >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace

std::string_view route_template(std::string_view path) {
  for (const std::string_view pattern : templates)
    if (fits(path, pattern)) return pattern;
  return "other";
}

void Metrics::count(std::string_view method, std::string_view path, int status, double seconds, std::uint64_t bytes_in,
                    std::uint64_t bytes_out) {
  const Route route{known_method(method), route_template(path)};
  const auto slot = std::lower_bound(bounds.begin(), bounds.end(), seconds) - bounds.begin();
  const std::lock_guard lock(mutex_);
  ++requests_[{route, status}];
  Durations& durations = durations_[route];
  ++durations.counts[static_cast<std::size_t>(slot)];
  durations.sum += seconds;
  bytes_in_ += bytes_in;
  bytes_out_ += bytes_out;
}

void Metrics::watch(std::string name, std::string help, std::string label, std::function<Measured()> measure) {
  gauges_.push_back({std::move(name), std::move(help), std::move(label), std::move(measure)});
}

void Metrics::write_requests(std::string& out) const {
  const auto labels = [](const Route& route) {
    return "{method=\"" + std::string(route.method) + "\",route=\"" + std::string(route.path) + "\"";
  };
  std::map<int, std::uint64_t> rejected = {{413, 0}, {429, 0}, {503, 0}, {507, 0}};
  header(out, "terrane_http_requests_total", "counter", "Requests answered.");
  for (const auto& [key, count] : requests_) {
    out += "terrane_http_requests_total" + labels(key.first) + ",status=\"" + std::to_string(key.second) + "\"} " +
           std::to_string(count) + "\n";
    if (const auto found = rejected.find(key.second); found != rejected.end()) found->second += count;
  }
  header(out, "terrane_http_rejected_total", "counter", "Requests refused because they or the load were too large.");
  for (const auto& [status, count] : rejected) {
    out += "terrane_http_rejected_total{status=\"" + std::to_string(status) + "\"} " + std::to_string(count) + "\n";
  }
  const std::string name = "terrane_http_request_duration_seconds";
  header(out, name, "histogram", "From the first byte of a request to the last of its answer.");
  for (const auto& [route, durations] : durations_) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i <= bounds.size(); ++i) {
      sum += durations.counts[i];
      out += name + "_bucket" + labels(route) + ",le=\"" + (i < bounds.size() ? number(bounds[i]) : "+Inf") + "\"} " +
             std::to_string(sum) + "\n";
    }
    out += name + "_sum" + labels(route) + "} " + number(durations.sum) + "\n";
    out += name + "_count" + labels(route) + "} " + std::to_string(sum) + "\n";
  }
  header(out, "terrane_http_received_bytes_total", "counter", "Bytes of request bodies, unpacked.");
  out += "terrane_http_received_bytes_total " + std::to_string(bytes_in_) + "\n";
  header(out, "terrane_http_sent_bytes_total", "counter", "Bytes of answers' bodies.");
  out += "terrane_http_sent_bytes_total " + std::to_string(bytes_out_) + "\n";
}

void Metrics::write_gauges(std::string& out) const {
  for (const Gauge& gauge : gauges_) {
    Measured values;
    try {
      values = gauge.measure();
    } catch (const std::exception&) {
      continue;  // the rest is worth knowing all the more
    }
    header(out, gauge.name, "gauge", gauge.help);
    for (const auto& [value, measured] : values) {
      out += gauge.name + "{" + gauge.label + "=\"" + value + "\"} " + number(measured) + "\n";
    }
  }
}

std::string Metrics::text() const {
  std::string out;
  {
    const std::lock_guard lock(mutex_);
    write_requests(out);
  }
  write_gauges(out);
  single(out, "process_resident_memory_bytes", "gauge", "Resident memory of the service, without its workers.",
         resident_bytes());
  single(out, "process_cpu_seconds_total", "counter", "Processor time of the service.", cpu_seconds());
  single(out, "process_start_time_seconds", "gauge", "When the service started, in seconds since 1970.",
         std::chrono::duration<double>(start_.time_since_epoch()).count());
  header(out, "terrane_build_info", "gauge", "Always 1; what is built stands in the labels.");
  out += "terrane_build_info{version=\"" TERRANE_VERSION "\",compiler=\"" + std::string(__VERSION__) + "\"} 1\n";
  return out;
}

}  // namespace terrane
