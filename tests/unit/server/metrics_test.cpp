// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/metrics.hpp"

#include <regex>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

namespace terrane {
namespace {

bool has_line(const std::string& text, const std::string& line) {
  return ("\n" + text).find("\n" + line + "\n") != std::string::npos;
}

TEST(Metrics, RoutesAreOursWhateverThePath) {
  EXPECT_EQ(route_template("/"), "/");
  EXPECT_EQ(route_template("/processes/merge"), "/processes/{id}");
  EXPECT_EQ(route_template("/processes/merge/execution"), "/processes/{id}/execution");
  EXPECT_EQ(route_template("/jobs/0a/results/surface"), "/jobs/{id}/results/{output}");
  for (const char* path : {"", "x", "//", "/jobs/", "/jobs//results", "/jobs/a/b", "/health/", "/JOBS", "/metrics/x"})
    EXPECT_EQ(route_template(path), "other") << path;
}

TEST(Metrics, CountRequestsAndTheirTimes) {
  Metrics metrics;
  metrics.count("GET", "/jobs/1", 200, 0.003, 0, 100);
  metrics.count("GET", "/jobs/2", 200, 0.005, 7, 20);
  metrics.count("GET", "/jobs/2", 404, 1e9, 0, 0);
  metrics.count("BREW", "/\"\n", 503, 0.1, 0, 0);
  const std::string text = metrics.text(), name = "terrane_http_request_duration_seconds";
  EXPECT_TRUE(has_line(text, "terrane_http_requests_total{method=\"GET\",route=\"/jobs/{id}\",status=\"200\"} 2"))
      << text;
  EXPECT_TRUE(has_line(text, "terrane_http_requests_total{method=\"other\",route=\"other\",status=\"503\"} 1"));
  EXPECT_TRUE(has_line(text, "terrane_http_rejected_total{status=\"503\"} 1"));
  EXPECT_TRUE(has_line(text, "terrane_http_rejected_total{status=\"413\"} 0"));
  const std::string labels = "{method=\"GET\",route=\"/jobs/{id}\"";
  EXPECT_TRUE(has_line(text, name + "_bucket" + labels + ",le=\"0.001\"} 0"));
  EXPECT_TRUE(has_line(text, name + "_bucket" + labels + ",le=\"0.005\"} 2")) << "the bound belongs to it";
  EXPECT_TRUE(has_line(text, name + "_bucket" + labels + ",le=\"600\"} 2"));
  EXPECT_TRUE(has_line(text, name + "_bucket" + labels + ",le=\"+Inf\"} 3"));
  EXPECT_TRUE(has_line(text, name + "_count" + labels + "} 3"));
  EXPECT_TRUE(has_line(text, "terrane_http_received_bytes_total 7"));
  EXPECT_TRUE(has_line(text, "terrane_http_sent_bytes_total 120"));
}

TEST(Metrics, AreWrittenAsPrometheusReadsThem) {
  Metrics metrics;
  metrics.count("GET", "/", 200, 0.5, 0, 0);
  metrics.watch("terrane_jobs", "Jobs by status.", "status", [] {
    return Measured{{"running", 2}, {"failed", 12345678}};
  });
  metrics.watch("terrane_broken", "Never there.", "a", []() -> Measured { throw std::runtime_error("no store"); });
  const std::string text = metrics.text();
  EXPECT_TRUE(has_line(text, "terrane_jobs{status=\"running\"} 2"));
  EXPECT_TRUE(has_line(text, "terrane_jobs{status=\"failed\"} 12345678"));
  EXPECT_EQ(text.find("terrane_broken"), std::string::npos);
  EXPECT_NE(text.find("terrane_build_info{version=\""), std::string::npos);
  const std::regex comment("# (HELP|TYPE) [a-z_]+ .+");
  const std::regex sample(R"re([a-z_]+(\{[a-z]+="[^"\\\n]*"(,[a-z]+="[^"\\\n]*")*\})? [0-9.e+]+)re");
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(std::regex_match(line, line.starts_with("#") ? comment : sample)) << line;
  std::smatch resident;
  ASSERT_TRUE(std::regex_search(text, resident, std::regex("\nprocess_resident_memory_bytes ([0-9]+)\n")));
  EXPECT_GT(std::stod(resident[1]), 1e6);
}

TEST(Metrics, LoseNothingBetweenThreads) {
  Metrics metrics;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int k = 0; k < 1000; ++k) metrics.count("GET", "/health", 200, 0.001, 1, 1);
      metrics.text();
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_TRUE(
      has_line(metrics.text(), "terrane_http_requests_total{method=\"GET\",route=\"/health\",status=\"200\"} 4000"));
}

}  // namespace
}  // namespace terrane
