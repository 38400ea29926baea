// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/data_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "core/error.hpp"
#include "server/worker/sandbox.hpp"

namespace terrane {

namespace fs = std::filesystem;

namespace {

constexpr off_t reserve_size = 4 << 20;

bool is_full(int error) { return error == ENOSPC || error == EDQUOT || error == EFBIG; }

[[noreturn]] void fail(int error, const fs::path& path) {
  if (is_full(error))
    throw Error(ErrorKind::storage_full, "storage-full",
                "There is no room left for this; send it again when there is.");
  throw Error(ErrorKind::internal, "storage-failed", path.string() + ": " + std::strerror(error));
}

void flush(const fs::path& path, int flags) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | flags);
  if (file < 0) fail(errno, path);
  const int error = fsync(file) == 0 ? 0 : errno;
  close(file);
  if (error) fail(error, path);
}

/// Workers may be of another user, and reach what they know the name of.
fs::path make_folder(const fs::path& path) {
  if (mkdir(path.c_str(), 0711) != 0 && errno != EEXIST) fail(errno, path);
  return path;
}

}  // namespace

std::string random_id() {
  unsigned char bytes[16];
  if (getrandom(bytes, sizeof bytes, 0) != sizeof bytes) fail(errno, "random numbers");
  std::string id;
  for (const unsigned char byte : bytes) {
    id += "0123456789abcdef"[byte >> 4];
    id += "0123456789abcdef"[byte & 15];
  }
  return id;
}

bool is_id(std::string_view text) {
  return text.size() == 32 && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

NewFile::NewFile(fs::path path) : path_(std::move(path)) {
  file_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (file_ < 0) fail(errno, path_);
}

NewFile::~NewFile() {
  if (file_ >= 0) close(file_);
  if (!kept_) unlink(path_.c_str());
}

void NewFile::write(std::string_view piece) {
  while (!piece.empty()) {
    const ssize_t n = ::write(file_, piece.data(), piece.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(errno, path_);
    piece.remove_prefix(static_cast<std::size_t>(n));
  }
}

void NewFile::keep() {
  // Some file systems say only now that there was no room.
  const int error = close(file_) == 0 ? 0 : errno;
  file_ = -1;
  if (error) fail(error, path_);
  kept_ = true;
}

void write_file(const fs::path& path, std::string_view content) {
  NewFile file(path);
  file.write(content);
  file.keep();
}

void flush_folder(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_directory())
      flush_folder(entry.path());
    else if (entry.is_regular_file())
      flush(entry.path(), O_NOFOLLOW);
  }
  if (error) fail(error.value(), folder);
  flush(folder, O_DIRECTORY);
}

void rename_flushed(const fs::path& from, const fs::path& to) {
  if (rename(from.c_str(), to.c_str()) != 0) {
    if (errno != ENOTEMPTY && errno != EEXIST) fail(errno, to);
    std::error_code ignored;
    fs::remove_all(to, ignored);
    if (rename(from.c_str(), to.c_str()) != 0) fail(errno, to);
  }
  flush(to.parent_path(), O_DIRECTORY);
}

Folder::Folder(fs::path path) : path_(std::move(path)) {
  make_folder(path_);
  if (geteuid() == 0 && chown(path_.c_str(), worker_user, worker_user) != 0) fail(errno, path_);
}

Folder::~Folder() {
  std::error_code ignored;
  if (!stays_) fs::remove_all(path_, ignored);
}

void Folder::become(const fs::path& name) {
  flush_folder(path_);
  rename_flushed(path_, name);
  path_ = name;
  stays_ = true;
}

DataFolder::DataFolder(fs::path root, const std::string& server, bool alone) : server_(server) {
  try {
    std::error_code error;
    fs::create_directories(root, error);
    root_ = fs::canonical(root);
    if (access(root_.c_str(), R_OK | W_OK | X_OK) != 0) fail(errno, root_);
    if (alone) lock();
    make_folder(root_ / "jobs");
    make_folder(root_ / "uploads");
    make_folder(root_ / "work");
    fs::remove_all(root_ / "work" / server_, error);
    make_folder(root_ / "work" / server_);
  } catch (const Error& error) {
    if (error.kind == ErrorKind::usage) throw;
    throw Error(
        ErrorKind::usage, "bad-data-folder",
        "The folder for jobs and results cannot be used: " + std::string(error.what()) + "; name another with --data.");
  } catch (const std::exception& exception) {
    throw Error(ErrorKind::usage, "bad-data-folder",
                "The folder for jobs and results cannot be used: " + std::string(exception.what()) +
                    "; name another with --data.");
  }
  take_reserve();
}

/// Before anything is removed: it may be in use. The lock goes with the process, however that ends.
void DataFolder::lock() {
  lock_ = open((root_ / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (lock_ < 0) fail(errno, root_ / "lock");
  if (flock(lock_, LOCK_EX | LOCK_NB) != 0)
    throw Error(ErrorKind::usage, "data-folder-in-use",
                "Another service works in " + root_.string() + "; stop it, or name another folder with --data.");
}

DataFolder::~DataFolder() {
  if (lock_ >= 0) close(lock_);
}

void DataFolder::remove_older(const fs::path& folder, std::chrono::milliseconds age) const {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path() == work()) continue;
    const auto changed = entry.last_write_time(error);
    if (!error && fs::file_time_type::clock::now() - changed > age) fs::remove_all(entry.path(), error);
  }
}

void DataFolder::release_reserve() const { unlink((root_ / "reserve").c_str()); }

bool DataFolder::take_reserve() const {
  const fs::path path = root_ / "reserve";
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  struct stat now;
  const bool is_there = file >= 0 && fstat(file, &now) == 0 && now.st_size >= reserve_size &&
                        now.st_blocks * 512 >= reserve_size;  // else some file systems write it all again
  const int error = file < 0 ? errno : is_there ? 0 : posix_fallocate(file, 0, reserve_size);
  if (file >= 0) close(file);
  if (error) unlink(path.c_str());
  return !is_full(error);
}

void DataFolder::require_reserve() const {
  if (!take_reserve()) fail(ENOSPC, root_);
}

fs::path default_data_folder() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value ? value : "");
  };
  if (const std::string state = variable("XDG_STATE_HOME"); state.starts_with('/')) return fs::path(state) / "terrane";
  if (const std::string home = variable("HOME"); home.starts_with('/')) return fs::path(home) / ".local/state/terrane";
  return "/var/lib/terrane";
}

}  // namespace terrane
