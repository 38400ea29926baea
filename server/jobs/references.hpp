// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "server/data_folder.hpp"
#include "server/jobs/job_store.hpp"
#include "server/requests/outbound.hpp"

namespace terrane {

/// Inputs by reference: results of our jobs ("/jobs/ID/results/OUTPUT"), uploads ("/uploads/ID"), both also with our
/// own address before them, and places on the allow-list.
class References {
 public:
  References(const DataFolder& data, JobStore& jobs, const Outbound& outbound, std::uint64_t max_bytes)
      : data_(data), jobs_(jobs), outbound_(outbound), max_bytes_(max_bytes) {}

  /// Brings what `href` points at into the folder of an execution, where it stays whatever becomes of the original, and
  /// says what it is: {"file", "name", "media_type"}; `base`: how the client addressed us. What is there already is
  /// answered from refs.json. Throws Error.
  nlohmann::json resolve(const std::filesystem::path& folder, const std::string& base, const std::string& href) const;

 private:
  nlohmann::json bring(const std::filesystem::path& folder, const std::string& file, const std::string& base,
                       const std::string& href) const;
  const DataFolder& data_;
  JobStore& jobs_;
  const Outbound& outbound_;
  const std::uint64_t max_bytes_;
};

/// Where an output of a job that is over lies, and what it is; of a job that is not, has no results or no such output
/// the HttpError that says so.
struct StoredOutput {
  std::filesystem::path file;
  nlohmann::json description;  // "media_type", "file_name", "size", "sha256"
};
StoredOutput stored_output(const DataFolder& data, const Job& job, const std::string& output);

/// Throws HttpError 404 "result-not-ready", or what the job failed with.
void require_results(const Job& job);

}  // namespace terrane
