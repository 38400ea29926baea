// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/jobs/job_store.hpp"

// The little that a store of jobs wants from an SQL database. What SQLite and PostgreSQL understand alike is written
// once, in job_store.cpp.
namespace terrane {

using SqlValue = std::variant<std::monostate, std::int64_t, std::string>;
using SqlRow = std::vector<std::optional<std::string>>;

enum class Durability {
  now,  // it is on stable storage when the statement is done
  soon  // or a little later, without a wait for the disk
};

class SqlDatabase {
 public:
  virtual ~SqlDatabase() = default;

  /// Runs one statement with the parameters $1, $2 ... Where an answer can be lost the statement is run again, so doing
  /// it twice must be as good as doing it once. Safe to use from several threads; throws as JobStore does.
  virtual std::vector<SqlRow> run(const std::string& sql, const std::vector<SqlValue>& values,
                                  Durability durability = Durability::now) = 0;
};

inline constexpr int job_schema_version = 2;

/// The statements that bring the table terrane_jobs from a version (0: there is none) to this one. Its column `number`,
/// the place in the line, is declared so.
std::string job_schema(int from, std::string_view number);

/// What only reads goes through `reader`, which may be the same: who looks at a job need not wait until another is
/// written to the disk. `skip_locked` is what follows a SELECT of rows that others must not get as well, where that has
/// to be said.
std::unique_ptr<JobStore> make_job_store(std::shared_ptr<SqlDatabase> database, std::shared_ptr<SqlDatabase> reader,
                                         std::string_view skip_locked);

[[noreturn]] void fail_store(const std::string& what);
[[noreturn]] void fail_store_full(const std::string& what);

}  // namespace terrane
