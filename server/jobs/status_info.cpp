// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/jobs/status_info.hpp"

#include <cstdio>
#include <ctime>

#include "server/http/open_file.hpp"

namespace terrane {

std::string base_of(const DataFolder& data, const Job& job) {
  return nlohmann::json::parse(OpenFile(data.job(job.id) / "call.json").text()).value("base", "");
}

std::string timestamp(Instant instant) {
  const std::time_t seconds = instant / 1000;
  std::tm utc;
  gmtime_r(&seconds, &utc);
  char text[40];
  const std::size_t n = std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
  std::snprintf(text + n, sizeof text - n, ".%03dZ", static_cast<int>(instant % 1000));
  return text;
}

nlohmann::json status_info(const Job& job, const std::string& base) {
  const std::string self = base + "/jobs/" + job.id;
  const auto link = [&](const std::string& href, const char* rel, const char* type, const char* title) {
    return nlohmann::json{{"href", href}, {"rel", rel}, {"type", type}, {"title", title}};
  };
  nlohmann::json info = {{"processID", job.operation},
                         {"type", "process"},
                         {"jobID", job.id},
                         {"status", word(job.status)},
                         {"message", job.message},
                         {"created", timestamp(job.created)},
                         {"updated", timestamp(job.updated)},
                         {"progress", job.status == JobStatus::successful ? 100 : job.progress}};
  if (job.started) info["started"] = timestamp(*job.started);
  if (job.finished) info["finished"] = timestamp(*job.finished);
  if (job.expires) info["expires"] = timestamp(*job.expires);
  info["links"] = {link(self, "self", "application/json", "This job"),
                   link(self, "alternate", "text/html", "This job for people"),
                   link(self + "/events", "monitor", "text/event-stream", "Its progress as it happens")};
  if (job.status == JobStatus::successful)
    info["links"].push_back(
        link(self + "/results", "http://www.opengis.net/def/rel/ogc/1.0/results", "application/json", "Its results"));
  if (job.status == JobStatus::failed)
    info["links"].push_back(link(self + "/results", "http://www.opengis.net/def/rel/ogc/1.0/exceptions",
                                 "application/problem+json", "Why it failed"));
  return info;
}

}  // namespace terrane
