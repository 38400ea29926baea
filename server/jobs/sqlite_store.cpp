// SPDX-License-Identifier: GPL-3.0-or-later
#include <sqlite3.h>

#include <cerrno>
#include <chrono>
#include <mutex>
#include <thread>
#include <unordered_map>

#include "server/jobs/sql_database.hpp"

namespace terrane {

namespace {

constexpr int busy_milliseconds = 5000;
constexpr std::size_t max_prepared = 100;  // lists differ in how many words they filter by

struct Close {
  void operator()(sqlite3* connection) const { sqlite3_close_v2(connection); }
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, Close>;

/// One connection, used by one thread at a time.
class SqliteDatabase : public SqlDatabase {
 public:
  explicit SqliteDatabase(const std::string& file) {
    sqlite3* connection = nullptr;
    const int code = sqlite3_open_v2(file.empty() ? ":memory:" : file.c_str(), &connection,
                                     SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
    connection_.reset(connection);
    if (code != SQLITE_OK) fail();
    sqlite3_extended_result_codes(connection, 1);
    sqlite3_busy_timeout(connection, busy_milliseconds);
    wait_for_others_to_switch();
    const std::string mode = run("PRAGMA journal_mode = WAL", {}).at(0).at(0).value_or("");
    if (mode != "wal" && !file.empty()) fail_store("no write-ahead log can be kept beside it");
    execute(full);
    make_table();
  }

  std::vector<SqlRow> run(const std::string& sql, const std::vector<SqlValue>& values, Durability durability) override {
    const std::lock_guard lock(mutex_);
    if (durability == Durability::now) return run(sql, values);
    execute("PRAGMA synchronous = NORMAL");
    struct Full {
      SqliteDatabase& database;
      ~Full() { sqlite3_exec(database.connection_.get(), full, nullptr, nullptr, nullptr); }
    } const after{*this};
    return run(sql, values);
  }

 private:
  /// The library waits for locks, but not for another that is switching to the log at the same moment.
  void wait_for_others_to_switch() {
    const auto busy = [&] {
      return (sqlite3_exec(connection_.get(), "PRAGMA journal_mode = WAL", nullptr, nullptr, nullptr) & 0xff) ==
             SQLITE_BUSY;
    };
    for (int waited = 0; waited < busy_milliseconds && busy(); waited += 5)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }

  static constexpr const char* full = "PRAGMA synchronous = FULL";

  std::vector<SqlRow> run(const std::string& sql, const std::vector<SqlValue>& values) {
    sqlite3_stmt* const statement = prepared(sql);
    struct Reset {
      sqlite3_stmt* statement;
      ~Reset() {
        sqlite3_reset(statement);
        sqlite3_clear_bindings(statement);
      }
    } const reset{statement};
    for (std::size_t i = 0; i < values.size(); ++i) bind(statement, i + 1, values[i]);
    std::vector<SqlRow> rows;
    int code;
    errno = 0;
    while ((code = sqlite3_step(statement)) == SQLITE_ROW) {
      SqlRow& row = rows.emplace_back(sqlite3_column_count(statement));
      for (std::size_t i = 0; i < row.size(); ++i) {
        const int column = static_cast<int>(i);
        const auto text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
        if (text) row[i].emplace(text, sqlite3_column_bytes(statement, column));
      }
    }
    if (code != SQLITE_DONE) fail();
    return rows;
  }

  sqlite3_stmt* prepared(const std::string& sql) {
    if (const auto found = statements_.find(sql); found != statements_.end()) return found->second.get();
    if (statements_.size() >= max_prepared) statements_.clear();
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(connection_.get(), sql.c_str(), -1, &statement, nullptr) != SQLITE_OK) fail();
    return statements_.emplace(sql, statement).first->second.get();
  }

  void bind(sqlite3_stmt* statement, std::size_t number, const SqlValue& value) {
    // $1 is a name to SQLite; it counts parameters as they come.
    const int index = sqlite3_bind_parameter_index(statement, ('$' + std::to_string(number)).c_str());
    int code = SQLITE_OK;
    if (const auto* integer = std::get_if<std::int64_t>(&value)) {
      code = sqlite3_bind_int64(statement, index, *integer);
    } else if (const auto* text = std::get_if<std::string>(&value)) {
      code = sqlite3_bind_text64(statement, index, text->data(), text->size(), SQLITE_STATIC, SQLITE_UTF8);
    }
    if (code != SQLITE_OK) fail();
  }

  void execute(const std::string& sql) {
    errno = 0;
    if (sqlite3_exec(connection_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
  }

  void make_table() {
    execute("BEGIN IMMEDIATE");  // two may open the file at the same time
    const int version = std::stoi(run("PRAGMA user_version", {}).at(0).at(0).value());
    if (version < 0 || version > job_schema_version) {
      fail_store("the file was written by another Terrane (schema " + std::to_string(version) + ", this one knows " +
                 std::to_string(job_schema_version) + ")");
    }
    if (version < job_schema_version) {
      execute(job_schema(version, "integer PRIMARY KEY"));
      execute("PRAGMA user_version = " + std::to_string(job_schema_version));
    }
    execute("COMMIT");
  }

  [[noreturn]] void fail() const {
    const int system_error = errno;  // sqlite3_system_errno knows nothing of a COMMIT that fails
    sqlite3* const connection = connection_.get();
    const int code = sqlite3_errcode(connection) & 0xff;
    const int cause = code == SQLITE_IOERR || code == SQLITE_CANTOPEN ? system_error : 0;
    const std::string what = sqlite3_errmsg(connection);
    if (code == SQLITE_FULL || cause == ENOSPC || cause == EDQUOT || cause == EFBIG) fail_store_full(what);
    fail_store(what);
  }

  std::mutex mutex_;
  std::unique_ptr<sqlite3, Close> connection_;
  std::unordered_map<std::string, Statement> statements_;
};

}  // namespace

std::unique_ptr<JobStore> open_sqlite_store(const std::string& file) {
  const auto database = std::make_shared<SqliteDatabase>(file);
  return make_job_store(database, file.empty() ? database : std::make_shared<SqliteDatabase>(file), "");
}

}  // namespace terrane
