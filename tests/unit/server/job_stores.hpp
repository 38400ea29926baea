// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "server/jobs/job_store.hpp"
#include "unit/server/postgresql_server.hpp"

namespace terrane {

/// Every test of it runs on an empty store of each sort.
class Stores : public testing::TestWithParam<const char*> {
 protected:
  static PostgresqlServer& server() {
    static PostgresqlServer server;
    return server;
  }

  bool is_sqlite() const { return GetParam() == std::string("sqlite"); }

  void SetUp() override {
    if (is_sqlite()) return;
    if (!PostgresqlServer::is_installed()) GTEST_SKIP() << "no PostgreSQL server here (Debian package postgresql-15)";
    server().run("DROP TABLE IF EXISTS terrane_jobs");
  }

  std::string place() { return is_sqlite() ? (folder_.path / "jobs.db").string() : server().uri(); }
  std::unique_ptr<JobStore> open() { return open(place()); }
  std::unique_ptr<JobStore> open(const std::string& place) {
    return is_sqlite() ? open_sqlite_store(place) : open_postgresql_store(place);
  }

  // In memory, where it costs nothing to wait for the disk: a killed process loses nothing of it either.
  TemporaryFolder folder_{std::filesystem::exists("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path()};
};

inline Job job(const std::string& id, Instant created = 1000, const std::string& key = "") {
  Job job;
  job.id = id;
  job.operation = "merge";
  job.created = job.updated = created;
  job.idempotency_key = key;
  job.fingerprint = "print of " + id;
  return job;
}

inline std::vector<std::string> ids(const std::vector<Job>& jobs) {
  std::vector<std::string> ids;
  for (const Job& job : jobs) ids.push_back(job.id);
  return ids;
}

/// The code of the error that a function throws, or "".
template <typename Function>
std::string complaint(const Function& function, std::string* message = nullptr) {
  try {
    function();
  } catch (const Error& error) {
    if (message) *message = error.what();
    EXPECT_EQ(error.kind, error.code == "storage-full" ? ErrorKind::storage_full : ErrorKind::internal);
    return error.code;
  }
  return "";
}

}  // namespace terrane
