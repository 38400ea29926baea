// SPDX-License-Identifier: GPL-3.0-or-later
// GET /jobs, /jobs/{id}, /jobs/{id}/results, /jobs/{id}/results/{output}, /jobs/{id}/events; DELETE /jobs/{id}.
#include <charconv>
#include <chrono>
#include <ctime>
#include <limits>
#include <thread>

#include "core/error.hpp"
#include "ops/json_value.hpp"
#include "server/jobs/status_info.hpp"
#include "server/pages/html.hpp"
#include "server/pages/pages.hpp"
#include "server/service.hpp"

namespace terrane {

namespace {

using namespace std::chrono_literals;
constexpr std::size_t most_jobs = 1000;  // on one page
constexpr auto event_step = 250ms;
constexpr auto event_sign_of_life = 15s;

std::vector<std::string> list_of(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    words.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return words;
}

std::int64_t whole_number(const std::string& name, const std::string& text, std::int64_t least) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < least)
    throw HttpError(400, "bad-parameter",
                    "The parameter " + name + " takes a whole number from " + std::to_string(least) + ".");
  return value;
}

/// One or several, in milliseconds.
std::vector<std::int64_t> durations(const std::string& name, const std::string& text) {
  constexpr std::int64_t longest = std::numeric_limits<std::int64_t>::max() / 1000;
  std::vector<std::int64_t> result;
  for (const std::string& word : list_of(text)) result.push_back(1000 * std::min(longest, whole_number(name, word, 0)));
  return result;
}

[[noreturn]] void bad_datetime() {
  throw HttpError(400, "bad-parameter",
                  "datetime takes an instant such as 2026-01-31T12:00:00Z, or an interval of two with / between, of "
                  "which one may be '..'.");
}

/// RFC 3339, with or without fractions of a second.
Instant instant(const std::string& text) {
  std::tm parts{};
  const char* rest = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &parts);
  if (!rest) bad_datetime();
  int milliseconds = 0;
  if (*rest == '.') {
    const char* const point = rest++;
    for (int unit = 100; *rest >= '0' && *rest <= '9'; ++rest, unit /= 10) milliseconds += (*rest - '0') * unit;
    if (rest == point + 1) bad_datetime();
  }
  int hours = 0, minutes = 0;
  const std::string zone = rest;
  if (zone != "Z" && zone != "z") {
    if (zone.size() != 6 || (zone[0] != '+' && zone[0] != '-') || zone[3] != ':') bad_datetime();
    hours = static_cast<int>(whole_number("datetime", zone.substr(1, 2), 0));
    minutes = static_cast<int>(whole_number("datetime", zone.substr(4, 2), 0));
    if (zone[0] == '-') hours = -hours, minutes = -minutes;
  }
  return (static_cast<Instant>(timegm(&parts)) - hours * 3600 - minutes * 60) * 1000 + milliseconds;
}

void set_interval(JobFilter& filter, const std::string& text) {
  const auto slash = text.find('/');
  const auto bound = [](const std::string& end) -> std::optional<Instant> {
    if (end.empty() || end == "..") return std::nullopt;
    return instant(end);
  };
  filter.created_from = bound(text.substr(0, slash));
  filter.created_until = slash == std::string::npos ? filter.created_from : bound(text.substr(slash + 1));
  if (!filter.created_from && !filter.created_until) bad_datetime();
  // A whole second stands for all of it.
  if (slash == std::string::npos && text.find('.') == std::string::npos) *filter.created_until += 999;
}

JobFilter filter_of(const Call& call) {
  JobFilter filter;
  for (const auto& [name, text] : call.query) {
    if (name == "f") continue;
    if (name == "limit") {
      filter.limit = std::min<std::size_t>(most_jobs, static_cast<std::size_t>(whole_number(name, text, 1)));
    } else if (name == "offset") {
      filter.offset = static_cast<std::size_t>(whole_number(name, text, 0));
    } else if (name == "processID") {
      for (std::string& word : list_of(text)) filter.operations.push_back(std::move(word));
    } else if (name == "status") {
      for (const std::string& word : list_of(text)) {
        const auto status = job_status(word);
        if (!status)
          throw HttpError(
              400, "bad-parameter",
              "There is no status of that name; there are accepted, running, successful, failed, dismissed.");
        filter.statuses.push_back(*status);
      }
    } else if (name == "type") {
      for (const std::string& word : list_of(text))
        if (word != "process") filter.operations.push_back("no such type");
    } else if (name == "datetime") {
      set_interval(filter, text);
    } else if (name == "minDuration") {
      for (const std::int64_t bound : durations(name, text))
        filter.min_duration = std::max(bound, filter.min_duration.value_or(bound));
    } else if (name == "maxDuration") {
      for (const std::int64_t bound : durations(name, text))
        filter.max_duration = std::min(bound, filter.max_duration.value_or(bound));
    } else {
      throw HttpError(
          400, "unknown-parameter",
          "There is no parameter " + header_text(name) +
              " here; there are type, processID, status, datetime, minDuration, maxDuration, limit, offset, f.");
    }
  }
  return filter;
}

/// One job as JSON or as a page.
Reply shown(const Call& call, const Job& job) {
  return shaped(shape_wanted(call), "Job " + job.id, status_info(job, base_url(call)), job_html);
}

/// The pieces of "/jobs/ID/results/OUTPUT" after "/jobs".
std::vector<std::string> pieces(const std::string& path) {
  std::vector<std::string> result;
  for (std::size_t at = 6; at < path.size();) {
    const std::size_t end = std::min(path.find('/', at), path.size());
    result.push_back(path.substr(at, end - at));
    at = end + 1;
  }
  return result;
}

}  // namespace

Job Service::require_job(const std::string& id) {
  auto job = is_id(id) ? jobs_.find(id) : std::nullopt;
  if (!job) throw HttpError(404, "no-such-job", "There is no job of that id, or no longer; jobs are kept for a while.");
  return std::move(*job);
}

std::optional<Reply> Service::answer_jobs(const Call& call) {
  const auto parts = pieces(call.path);
  const bool is_results = parts.size() >= 2 && parts[1] == "results" && parts.size() <= 3;
  const bool is_events = parts.size() == 2 && parts[1] == "events";
  if (parts.size() > 1 && !is_results && !is_events) refuse_path();
  const std::string allowed = parts.size() == 1 ? "GET, HEAD, DELETE, OPTIONS" : "GET, HEAD, OPTIONS";
  if (call.method == "OPTIONS") return Reply{204, "", {{"Allow", allowed}}, ""};
  if (call.method == "DELETE" && parts.size() == 1) return dismiss_job(call, parts[0]);
  if (call.method != "GET")
    throw HttpError(405, "method-not-allowed", "This path takes " + allowed + ".", {{"Allow", allowed}});
  if (parts.empty()) return job_list(call);
  if (parts.size() == 1) return job_page(call, parts[0]);
  if (is_events) return job_events(call, parts[0]);
  try {
    return parts.size() == 2 ? job_results(call, parts[0]) : job_output(call, parts[0], parts[2]);
  } catch (const Error&) {
    require_job(parts[0]);  // when it was dismissed or expired meanwhile, that its files are gone is no mistake of ours
    throw;
  }
}

Reply Service::job_list(const Call& call) {
  const JobFilter filter = filter_of(call);
  const Shape shape =
      shape_wanted(call, {"type", "processID", "status", "datetime", "minDuration", "maxDuration", "limit", "offset"});
  const JobPage page = jobs_.list(filter);
  nlohmann::json jobs = nlohmann::json::array();
  for (const Job& job : page.jobs) jobs.push_back(status_info(job, base_url(call)));
  nlohmann::json links = shape_links(call, shape);
  const auto add = [&](std::size_t offset, const char* rel, const char* title) {
    links.push_back(link(address_with(call, {{"offset", std::to_string(offset)}}), rel,
                         shape == Shape::json ? "application/json" : "text/html", title));
  };
  if (filter.offset + page.jobs.size() < page.matched) add(filter.offset + page.jobs.size(), "next", "Earlier jobs");
  if (filter.offset > 0) add(filter.offset - std::min(filter.offset, filter.limit), "prev", "Later jobs");
  const nlohmann::json list = {
      {"jobs", jobs}, {"links", links}, {"numberMatched", page.matched}, {"numberReturned", page.jobs.size()}};
  return shaped(shape, "The jobs", list, job_list_html);
}

Reply Service::job_page(const Call& call, const std::string& id) { return shown(call, require_job(id)); }

Reply Service::dismiss_job(const Call& call, const std::string& id) {
  require_job(id);
  shape_wanted(call);  // a request that is refused leaves the job alone
  const auto job = jobs_.dismiss(id);
  if (!job) throw HttpError(404, "no-such-job", "There is no job of that id any more.");
  return shown(call, *job);
}

Reply Service::job_results(const Call& call, const std::string& id) {
  require_known_parameters(call, {}, "; one output is to be had in another format at its own path");
  const Job job = require_job(id);
  require_results(job);
  Reply reply = reply_of(job.outcome, data_.job(id) / job.outcome.at("folder").get<std::string>());
  if (job.outcome.at("outputs").contains("certificate"))
    reply.headers.emplace_back("Link", "</jobs/" + id +
                                           "/results/certificate>; rel=\"describedby\"; "
                                           "type=\"application/json\"");
  return reply;
}

/// Nothing when it is wanted in another format or otherwise changed, which takes work.
std::optional<Reply> Service::job_output(const Call& call, const std::string& id, const std::string& output) {
  const Job job = require_job(id);
  const StoredOutput stored = stored_output(data_, job, output);
  const auto& media_type = stored.description.at("media_type").get_ref<const std::string&>();
  const auto& name = stored.description.at("file_name").get_ref<const std::string&>();
  const bool is_meant = call.query.empty() ? is_accepted(accepted_media_types(call.accept), media_type)
                                           : call.query.size() == 1 && call.query[0].first == "f" &&
                                                 name.ends_with("." + call.query[0].second);
  if (!is_meant) return std::nullopt;
  auto file = std::make_shared<const OpenFile>(stored.file);
  Reply reply{200, media_type, {}, FileBody{file, 0, file->size(), stored.description.at("sha256")}};
  reply.headers = {{"Content-Disposition", "attachment; filename=\"" + header_text(name) + "\""}};
  return reply;
}

Reply Service::converted_output(const Call& call, const std::function<bool()>& client_is_gone) {
  Folder folder(data_.work(random_id()));
  const Order order{random_id(), "convert", base_url(call), "application/json", call.accept, call.query, 1};
  write_file(folder.path() / "call.json", json_text(to_json(order)));
  write_file(folder.path() / "body", nlohmann::json{{"inputs", {{"surface", {{"href", call.path}}}}}}.dump());
  return run_now(order, folder, client_is_gone);
}

/// Server-sent events: `status` whenever something changed, until the job is over.
Reply Service::job_events(const Call& call, const std::string& id) {
  require_job(id);
  require_known_parameters(call, {});
  const StreamBody events = [this, id, base = base_url(call)](const auto& write) {
    std::string last;
    auto silent_since = std::chrono::steady_clock::now();
    while (!closing_) {
      const auto job = jobs_.find(id);
      if (!job) return;
      const std::string now = status_info(*job, base).dump();
      if (now != last) {
        if (!write("event: status\ndata: " + now + "\n\n")) return;
        last = now;
        silent_since = std::chrono::steady_clock::now();
      }
      if (is_over(job->status)) return;
      if (std::chrono::steady_clock::now() - silent_since > event_sign_of_life) {
        if (!write(": still here\n\n")) return;
        silent_since = std::chrono::steady_clock::now();
      }
      std::this_thread::sleep_for(event_step);
    }
  };
  return {200, "text/event-stream", {{"Cache-Control", "no-store"}}, events};
}

}  // namespace terrane
