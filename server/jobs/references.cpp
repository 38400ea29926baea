// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/jobs/references.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/error.hpp"
#include "ops/json_value.hpp"
#include "server/http/message.hpp"
#include "server/http/open_file.hpp"
#include "server/worker/worker_channel.hpp"

namespace terrane {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t largest_list = 16 << 20;

[[noreturn]] void not_there(const std::string& href) {
  throw Error(ErrorKind::input, "no-such-reference",
              "There is nothing at " + href + "; it may have expired. Results and uploads are kept for a while.");
}

/// A second name for a file that may lose its first one.
void link_or_fail(const fs::path& from, const fs::path& to, const std::string& href) {
  if (link(from.c_str(), to.c_str()) == 0) return;
  if (errno == ENOENT) not_there(href);
  throw Error(ErrorKind::internal, "storage-failed", to.string() + ": " + std::strerror(errno));
}

}  // namespace

void require_results(const Job& job) {
  switch (job.status) {
    case JobStatus::successful:
      return;
    case JobStatus::failed:
      throw_failure(job.outcome.value("failure", nlohmann::json::object()));
    case JobStatus::dismissed:
      throw HttpError(410, "dismissed", "The job was dismissed; it has no results.");
    default:
      throw HttpError(404, "result-not-ready", "The job is not done yet; its status says how far it is.");
  }
}

StoredOutput stored_output(const DataFolder& data, const Job& job, const std::string& output) {
  require_results(job);
  const auto& outputs = job.outcome.at("outputs");
  if (!outputs.contains(output)) throw HttpError(404, "no-such-output", "The job has no output of that name.");
  const nlohmann::json& description = outputs[output];
  return {data.job(job.id) / job.outcome.at("folder").get<std::string>() / description.at("file").get<std::string>(),
          description};
}

nlohmann::json References::resolve(const fs::path& folder, const std::string& base, const std::string& href) const {
  const fs::path list = folder / "refs.json";
  nlohmann::json known = nlohmann::json::object();
  if (fs::exists(list)) known = nlohmann::json::parse(OpenFile(list).text(largest_list));
  if (known.contains(href)) return known[href];
  const nlohmann::json found = bring(folder, "ref-" + std::to_string(known.size()), base, href);
  known[href] = found;
  unlink(list.c_str());
  write_file(list, json_text(known));
  return found;
}

nlohmann::json References::bring(const fs::path& folder, const std::string& file, const std::string& base,
                                 const std::string& href) const {
  const std::string path = !base.empty() && href.starts_with(base + "/") ? href.substr(base.size()) : href;
  if (!path.starts_with('/')) {
    const Outbound::Fetched fetched = outbound_.fetch(href, folder / file, max_bytes_);
    return {{"file", file}, {"name", fetched.name}, {"media_type", fetched.media_type}};
  }
  constexpr std::string_view jobs = "/jobs/", results = "/results/", uploads = "/uploads/";
  if (path.starts_with(uploads) && is_id(path.substr(uploads.size()))) {
    const fs::path upload = data_.upload(path.substr(uploads.size()));
    link_or_fail(upload / "body", folder / file, href);
    nlohmann::json entry = nlohmann::json::parse(OpenFile(upload / "upload.json").text());
    return {{"file", file}, {"name", entry.at("name")}, {"media_type", entry.at("media_type")}};
  }
  const std::string id = path.starts_with(jobs) ? path.substr(jobs.size(), 32) : "";
  if (!is_id(id) || path.compare(jobs.size() + 32, results.size(), results) != 0) not_there(href);
  const auto job = jobs_.find(id);
  if (!job) not_there(href);
  try {
    const StoredOutput output = stored_output(data_, *job, path.substr(jobs.size() + 32 + results.size()));
    link_or_fail(output.file, folder / file, href);
    return {{"file", file},
            {"name", output.description.at("file_name")},
            {"media_type", output.description.at("media_type")}};
  } catch (const HttpError& error) {
    throw Error(ErrorKind::input, error.code, "The input " + href + ": " + error.what());
  }
}

}  // namespace terrane
