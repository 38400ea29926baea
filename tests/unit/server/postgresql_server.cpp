// SPDX-License-Identifier: GPL-3.0-or-later
#include "unit/server/postgresql_server.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <grp.h>
#include <libpq-fe.h>
#include <netinet/in.h>
#include <pwd.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace terrane {

namespace {

const std::filesystem::path programs = "/usr/lib/postgresql/15/bin";

const passwd* other_user() {
  if (geteuid() != 0) return nullptr;
  if (const passwd* user = getpwnam("postgres")) return user;
  return getpwnam("nobody");
}

}  // namespace

TemporaryFolder::TemporaryFolder(const std::filesystem::path& parent)
    : path([&] {
        std::string name = parent / "terrane-store-XXXXXX";
        if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
        return name;
      }()) {}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path, ignored);
}

int free_port() {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (bind(socket, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
      getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    throw std::runtime_error("no free port");
  }
  close(socket);
  return ntohs(address.sin_port);
}

bool PostgresqlServer::is_installed() { return std::filesystem::exists(programs / "postgres"); }

PostgresqlServer::PostgresqlServer() {
  std::ofstream(folder_.path / "password") << "secret word\n";
  give(folder_.path);
  give(folder_.path / "password");
  const pid_t maker =
      spawn({"initdb", "--no-sync", "--encoding=UTF8", "--no-locale", "--auth=scram-sha-256", "--username=terrane",
             "--pwfile=" + (folder_.path / "password").string(), "--pgdata=" + (folder_.path / "data").string()});
  int status = 0;
  waitpid(maker, &status, 0);
  if (status != 0)
    throw std::runtime_error("initdb failed: " +
                             (std::stringstream() << std::ifstream(folder_.path / "log").rdbuf()).str());
  port_ = free_port();
  start();
}

std::string PostgresqlServer::uri(const std::string& password, int port) const {
  return "postgresql://terrane:" + password + "@127.0.0.1:" + std::to_string(port ? port : port_) + "/postgres";
}

void PostgresqlServer::start() {
  process_ = spawn({"postgres", "-D", (folder_.path / "data").string(), "-p", std::to_string(port_), "-c",
                    "listen_addresses=127.0.0.1", "-c", "unix_socket_directories=", "-c", "shared_buffers=16MB", "-c",
                    "fsync=off"});
  for (int i = 0; i < 600; ++i) {
    if (PQping(uri().c_str()) == PQPING_OK) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  throw std::runtime_error("PostgreSQL does not start: " +
                           (std::stringstream() << std::ifstream(folder_.path / "log").rdbuf()).str());
}

void PostgresqlServer::crash() {
  if (process_ == 0) return;
  kill(process_, SIGQUIT);
  waitpid(process_, nullptr, 0);
  process_ = 0;
}

std::string PostgresqlServer::run(const std::string& sql) const {
  PGconn* const connection = PQconnectdb(uri().c_str());
  PGresult* const result = PQexec(connection, sql.c_str());
  const bool good = PQresultStatus(result) == PGRES_COMMAND_OK || PQresultStatus(result) == PGRES_TUPLES_OK;
  const std::string answer = good && PQntuples(result) > 0 ? PQgetvalue(result, 0, 0) : PQerrorMessage(connection);
  PQclear(result);
  PQfinish(connection);
  if (!good) throw std::runtime_error(sql + ": " + answer);
  return answer;
}

void PostgresqlServer::give(const std::filesystem::path& folder) const {
  const passwd* user = other_user();
  if (user && chown(folder.c_str(), user->pw_uid, user->pw_gid) != 0) throw std::runtime_error("chown");
}

pid_t PostgresqlServer::spawn(const std::vector<std::string>& words) const {
  const std::string program = programs / words[0], log = folder_.path / "log";
  // Its own name in full: it looks for its companions beside itself, and in PATH when its name has no folder.
  std::vector<char*> arguments{const_cast<char*>(program.c_str())};
  for (std::size_t i = 1; i < words.size(); ++i) arguments.push_back(const_cast<char*>(words[i].c_str()));
  arguments.push_back(nullptr);
  const passwd* user = other_user();
  const pid_t child = fork();
  if (child != 0) return child;
  if (user && (setgroups(0, nullptr) != 0 || setgid(user->pw_gid) != 0 || setuid(user->pw_uid) != 0)) _exit(1);
  prctl(PR_SET_PDEATHSIG, SIGQUIT);
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (file < 0 || dup2(file, 1) < 0 || dup2(file, 2) < 0) _exit(1);
  execv(program.c_str(), arguments.data());
  _exit(1);
}

}  // namespace terrane
