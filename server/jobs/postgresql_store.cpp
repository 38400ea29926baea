// SPDX-License-Identifier: GPL-3.0-or-later
#include <libpq-fe.h>

#include <chrono>
#include <mutex>

#include "server/jobs/sql_database.hpp"

namespace terrane {

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto pause_after_refusal = std::chrono::seconds(1);
constexpr Oid no_type = 0, int8_type = 20, text_type = 25;  // as in pg_type, which never changes these

struct Free {
  void operator()(PGconn* connection) const { PQfinish(connection); }
  void operator()(PGresult* result) const { PQclear(result); }
  void operator()(PQconninfoOption* options) const { PQconninfoFree(options); }
};
using Connection = std::unique_ptr<PGconn, Free>;
using Result = std::unique_ptr<PGresult, Free>;

/// A password that is not escaped ends up in the host or the port, and libpq quotes both in its messages. So what it
/// could misread is refused here, in words that quote nothing.
void check_uri(const std::string& uri) {
  const auto refuse = [] {
    fail_store(
        "this is no postgresql://user:password@host:port/database (write @ : / ? # % in a password as %40 and so on)");
  };
  if (!uri.starts_with("postgresql://") && !uri.starts_with("postgres://")) refuse();
  char* message = nullptr;
  const std::unique_ptr<PQconninfoOption, Free> options(PQconninfoParse(uri.c_str(), &message));
  PQfreemem(message);
  if (!options) refuse();
  for (const PQconninfoOption* option = options.get(); option->keyword; ++option) {
    if (!option->val) continue;
    const std::string keyword = option->keyword, value = option->val;
    if (keyword == "host" && value.find('@') != std::string::npos) refuse();
    if (keyword == "port" && value.find_first_not_of("0123456789,") != std::string::npos) refuse();
  }
}

/// Milliseconds, seconds: nothing waits for ever, neither for a lock nor for a peer that fell silent. The URI may say
/// otherwise of the connection.
Connection connect(const std::string& uri) {
  const char* const keywords[] = {"connect_timeout",
                                  "tcp_user_timeout",
                                  "keepalives_idle",
                                  "keepalives_interval",
                                  "keepalives_count",
                                  "application_name",
                                  "dbname",
                                  "client_encoding",
                                  nullptr};
  const char* const values[] = {"5", "10000", "10", "5", "3", "terrane", uri.c_str(), "UTF8", nullptr};
  return Connection(PQconnectdbParams(keywords, values, 1));
}

constexpr const char* session =
    "SET statement_timeout = 10000; SET default_transaction_isolation = 'read committed'; "
    "SET client_min_messages = error; "
    "SELECT set_config('synchronous_commit', 'on', false) WHERE current_setting('synchronous_commit') = 'off'";

bool is_good(const Result& result) {
  const auto status = PQresultStatus(result.get());
  return status == PGRES_TUPLES_OK || status == PGRES_COMMAND_OK;
}

/// One connection, used by one thread at a time and made anew when it is lost.
class PostgresqlDatabase : public SqlDatabase {
 public:
  explicit PostgresqlDatabase(const std::string& uri) : uri_(uri) {
    check_uri(uri);
    reconnect();
    make_table();
  }

  std::vector<SqlRow> run(const std::string& sql, const std::vector<SqlValue>& values, Durability durability) override {
    std::vector<std::string> digits(values.size());
    std::vector<const char*> texts(values.size());
    std::vector<Oid> types(values.size(), no_type);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (const auto* integer = std::get_if<std::int64_t>(&values[i])) {
        digits[i] = std::to_string(*integer);
        texts[i] = digits[i].c_str();
        types[i] = int8_type;
      } else if (const auto* text = std::get_if<std::string>(&values[i])) {
        texts[i] = text->c_str();
        types[i] = text_type;
      }
    }
    const std::lock_guard lock(mutex_);
    for (bool again = false;; again = true) {
      if (!connection_) reconnect();
      const bool is_lazy = durability == Durability::soon;
      if (is_lazy) Result(PQexec(connection_.get(), "BEGIN; SET LOCAL synchronous_commit = off"));
      const Result result(PQexecParams(connection_.get(), sql.c_str(), static_cast<int>(values.size()), types.data(),
                                       texts.data(), nullptr, nullptr, 0));
      if (is_lazy) Result(PQexec(connection_.get(), "COMMIT"));  // or a rollback, when the statement failed
      if (is_good(result)) return rows_of(result);
      const bool is_lost = PQstatus(connection_.get()) == CONNECTION_BAD;
      if (!is_lost) fail(result);
      connection_.reset();
      if (again) fail_store("the connection to PostgreSQL was lost");
    }
  }

 private:
  static std::vector<SqlRow> rows_of(const Result& result) {
    std::vector<SqlRow> rows(PQntuples(result.get()), SqlRow(PQnfields(result.get())));
    for (std::size_t y = 0; y < rows.size(); ++y) {
      for (std::size_t x = 0; x < rows[y].size(); ++x) {
        const int row = static_cast<int>(y), column = static_cast<int>(x);
        if (PQgetisnull(result.get(), row, column)) continue;
        rows[y][x].emplace(PQgetvalue(result.get(), row, column), PQgetlength(result.get(), row, column));
      }
    }
    return rows;
  }

  void reconnect() {
    // While it cannot be reached, whoever waits for the mutex need not wait for a timeout of their own as well.
    if (Clock::now() < refused_until_) fail_store(refusal_);
    connection_ = connect(uri_);
    if (PQstatus(connection_.get()) == CONNECTION_OK && is_good(Result(PQexec(connection_.get(), session)))) return;
    refusal_ = "PostgreSQL cannot be reached: " + without_secrets(PQerrorMessage(connection_.get()));
    refused_until_ = Clock::now() + pause_after_refusal;
    connection_.reset();
    fail_store(refusal_);
  }

  std::string without_secrets(std::string message) const {
    const std::string hidden = "...";
    for (const char* secret : {PQpass(connection_.get()), PQuser(connection_.get())}) {
      const std::string text = secret ? secret : "";
      if (text.empty()) continue;
      for (std::size_t at = 0; (at = message.find(text, at)) != std::string::npos; at += hidden.size()) {
        message.replace(at, text.size(), hidden);
      }
    }
    while (message.ends_with('\n')) message.pop_back();
    return message;
  }

  void make_table() {
    // Of several servers that start at the same time one makes it. The schema is in the comment of the table.
    execute("BEGIN; SELECT pg_advisory_xact_lock(5499121)");
    const auto found = rows_of(execute(
        "SELECT coalesce(obj_description(t.oid, 'pg_class'), '') FROM (SELECT to_regclass('terrane_jobs') AS oid) t "
        "WHERE t.oid IS NOT NULL"));
    const auto named = [](int version) { return "Terrane schema " + std::to_string(version); };
    const std::string comment = found.empty() ? named(0) : found[0][0].value_or("");
    int version = found.empty() ? 0 : 1;
    while (version < job_schema_version && comment != named(version)) ++version;
    if (comment != named(version)) {
      fail_store("the table terrane_jobs is not of this Terrane: its comment says '" + comment + "' instead of '" +
                 named(job_schema_version) + "'");
    }
    if (version < job_schema_version) {
      execute(job_schema(version, "bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY"));
      execute("COMMENT ON TABLE terrane_jobs IS '" + named(job_schema_version) + "'");
    }
    execute("COMMIT");
  }

  Result execute(const std::string& sql) {
    Result result(PQexec(connection_.get(), sql.c_str()));
    if (!is_good(result)) fail(result);
    return result;
  }

  [[noreturn]] static void fail(const Result& result) {
    const auto field = [&](int code) {
      const char* const text = PQresultErrorField(result.get(), code);
      return std::string(text ? text : "");
    };
    const std::string state = field(PG_DIAG_SQLSTATE);
    const std::string what = field(PG_DIAG_MESSAGE_PRIMARY) + " (SQLSTATE " + state + ")";
    if (state == "53100") fail_store_full(what);
    fail_store(what);
  }

  const std::string uri_;
  std::mutex mutex_;
  Connection connection_;
  std::string refusal_;
  Clock::time_point refused_until_;
};

}  // namespace

std::unique_ptr<JobStore> open_postgresql_store(const std::string& uri) {
  const auto database = std::make_shared<PostgresqlDatabase>(uri);
  return make_job_store(database, std::make_shared<PostgresqlDatabase>(uri), " FOR UPDATE SKIP LOCKED");
}

}  // namespace terrane
