// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace terrane {

/// A folder of a test, gone with it.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::filesystem::path& parent = std::filesystem::temp_directory_path());
  TemporaryFolder(const TemporaryFolder&) = delete;
  ~TemporaryFolder();
  const std::filesystem::path path;
};

/// A PostgreSQL server of our own, on loopback. It runs as somebody else when we are root, since it refuses to be root,
/// and dies with us however we die. It never waits for the disk: what a test kills are processes, and those leave what
/// they wrote to the system.
class PostgresqlServer {
 public:
  static bool is_installed();

  PostgresqlServer();
  PostgresqlServer(const PostgresqlServer&) = delete;
  ~PostgresqlServer() { crash(); }

  std::string uri(const std::string& password = "secret%20word", int port = 0) const;
  int port() const { return port_; }
  void start();
  /// As if the power had gone: nothing is written any more.
  void crash();
  /// One statement by the superuser, which must succeed; what it says in its first row and column.
  std::string run(const std::string& sql) const;
  /// The folder is the server's from now on.
  void give(const std::filesystem::path& folder) const;

 private:
  pid_t spawn(const std::vector<std::string>& words) const;

  TemporaryFolder folder_;
  int port_ = 0;
  pid_t process_ = 0;
};

/// A port of loopback that is free now.
int free_port();

}  // namespace terrane
