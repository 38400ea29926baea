// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// What the service has done, for Prometheus to ask for. Safe to use from several threads.
namespace terrane {

/// The path with names instead of what a client chose, "/jobs/{id}/results"; "other" for a path that is none of ours.
std::string_view route_template(std::string_view path);

/// Values of something that is measured when it is asked for, by the value of the one label.
using Measured = std::vector<std::pair<std::string, double>>;

class Metrics {
 public:
  /// One answered request. The path may be anything: only its route is kept.
  void count(std::string_view method, std::string_view path, int status, double seconds, std::uint64_t bytes_in,
             std::uint64_t bytes_out);

  /// Adds a gauge: "terrane_jobs", "Jobs by status.", "status" and what measures it. The labels' values are ours, never
  /// a client's. `measure` is called for every scrape, from any thread, and must be quick; when it throws, the gauge is
  /// left out of that answer. Call before the service runs.
  void watch(std::string name, std::string help, std::string label, std::function<Measured()> measure);

  /// Everything in Prometheus' text format 0.0.4.
  std::string text() const;

 private:
  static constexpr std::array<double, 12> bounds = {0.001, 0.005, 0.02, 0.1, 0.25, 0.5, 1, 2.5, 10, 30, 120, 600};

  struct Durations {
    std::array<std::uint64_t, bounds.size() + 1> counts{};  // not yet summed up; the last one beyond all bounds
    double sum = 0;
  };
  struct Route {
    std::string_view method, path;
    auto operator<=>(const Route&) const = default;
  };
  struct Gauge {
    std::string name, help, label;
    std::function<Measured()> measure;
  };

  void write_requests(std::string& out) const;
  void write_gauges(std::string& out) const;

  mutable std::mutex mutex_;
  std::map<std::pair<Route, int>, std::uint64_t> requests_;
  std::map<Route, Durations> durations_;
  std::uint64_t bytes_in_ = 0, bytes_out_ = 0;
  std::vector<Gauge> gauges_;
  const std::chrono::system_clock::time_point start_ = std::chrono::system_clock::now();
};

}  // namespace terrane
