// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "server/data_folder.hpp"
#include "server/jobs/job_store.hpp"

// What clients are told of a job.
namespace terrane {

/// How the client that ordered it addressed us.
std::string base_of(const DataFolder& data, const Job& job);
/// OGC API - Processes 1.0, statusInfo.yaml, with links from `base`.
nlohmann::json status_info(const Job& job, const std::string& base);
/// RFC 3339, UTC, milliseconds.
std::string timestamp(Instant instant);

}  // namespace terrane
