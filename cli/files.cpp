// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/error.hpp"

namespace terrane {
namespace {

[[noreturn]] void fail(ErrorKind kind, const char* code, const std::string& what, const std::string& path) {
  throw Error(kind, code, what + " '" + path + "': " + std::strerror(errno));
}

/// A disk that takes no more is a limit of the machine; everything else is wrong with the name that was asked for.
[[noreturn]] void fail_to_store(const char* what, const std::string& path) {
  const bool full = errno == ENOSPC || errno == EDQUOT || errno == EFBIG || errno == EIO;
  if (full) fail(ErrorKind::limit, "disk-full", what, path);
  fail(ErrorKind::output, "not-stored", what, path);
}

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ > 2) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

int open_input(const std::string& path) {
  const int fd = path == "-" ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) fail(ErrorKind::input, "not-readable", "cannot read", path);
  return fd;
}

/// 0 at the end.
std::size_t read_some(int fd, char* to, std::size_t size, const std::string& path) {
  for (;;) {
    const ssize_t n = ::read(fd, to, size);
    if (n >= 0) return static_cast<std::size_t>(n);
    if (errno != EINTR) fail(ErrorKind::input, "not-readable", "cannot read", path);
  }
}

InputStream open_stream(const std::string& path) {
  const auto file = std::make_shared<Descriptor>(open_input(path));
  struct stat facts {};
  if (::fstat(file->get(), &facts) != 0) fail(ErrorKind::input, "not-readable", "cannot read", path);
  return {[file, path](char* to, std::size_t size) { return read_some(file->get(), to, size, path); },
          static_cast<std::size_t>(facts.st_size)};
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
}

/// Moves a finished file to its name; where nothing may be replaced, a name taken in the meantime is a refusal too.
void put_in_place(const std::string& temporary, const std::string& path, bool force) {
  if (force ? ::rename(temporary.c_str(), path.c_str()) == 0 : ::link(temporary.c_str(), path.c_str()) == 0) {
    if (!force) ::unlink(temporary.c_str());
    return;
  }
  if (!force && errno != EEXIST && ::access(path.c_str(), F_OK) != 0 && ::rename(temporary.c_str(), path.c_str()) == 0)
    return;
  const int reason = errno;
  ::unlink(temporary.c_str());
  errno = reason;
  fail_to_store("cannot store", path);
}

}  // namespace

std::string file_name(const std::string& path) { return path.substr(path.rfind('/') + 1); }

void read_file(const std::string& path, InputPart& part) {
  const Descriptor file(open_input(path));
  struct stat facts {};
  // Standard input is one place that all who open it share, a file behind it or not.
  const bool regular = path != "-" && ::fstat(file.get(), &facts) == 0 && S_ISREG(facts.st_mode);
  std::vector<char> block(1 << 16);
  const bool large = regular && static_cast<std::size_t>(facts.st_size) > block.size();
  if (large) part.open = [path] { return open_stream(path); };
  do {
    const std::size_t count = read_some(file.get(), block.data(), block.size(), path);
    if (count == 0) return;
    part.bytes.append(block.data(), count);
  } while (!large);
}

std::string read_whole_file(const std::string& path) {
  const Descriptor file(open_input(path));
  std::string bytes;
  std::vector<char> block(1 << 16);
  while (const std::size_t count = read_some(file.get(), block.data(), block.size(), path))
    bytes.append(block.data(), count);
  return bytes;
}

void refuse_existing(const std::string& path, bool force) {
  struct stat facts {};
  if (path.empty() || path == "-" || ::stat(path.c_str(), &facts) != 0) return;
  if (S_ISDIR(facts.st_mode)) throw Error(ErrorKind::usage, "output-exists", "'" + path + "' is a folder");
  if (S_ISREG(facts.st_mode) && !force)
    throw Error(ErrorKind::usage, "output-exists", "'" + path + "' exists; say --force to replace it");
}

bool OutputFile::holds_back() const {
  struct stat facts {};
  return path_ != "-" && (::stat(path_.c_str(), &facts) != 0 || S_ISREG(facts.st_mode));
}

void OutputFile::open() {
  if (path_ == "-") {
    fd_ = STDOUT_FILENO;
  } else if (!holds_back()) {
    fd_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    std::string name = folder_of(path_) + "/." + file_name(path_) + ".XXXXXX";
    fd_ = ::mkostemp(name.data(), O_CLOEXEC);
    if (fd_ >= 0) temporary_ = name;
  }
  if (fd_ < 0) fail_to_store("cannot write", path_);
}

void OutputFile::write(std::string_view bytes) {
  constexpr std::size_t piece = 8 << 20;
  if (fd_ < 0) open();
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd_, bytes.data(), std::min(bytes.size(), piece));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail_to_store("cannot write", path_);
    // The disk begins while the rest is made, and keep() finds less to wait for.
    if (!temporary_.empty()) ::sync_file_range(fd_, 0, 0, SYNC_FILE_RANGE_WRITE);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

void OutputFile::keep() {
  if (fd_ < 0) open();
  if (temporary_.empty()) return;
  const mode_t mask = ::umask(0);
  ::umask(mask);
  if (::fchmod(fd_, 0666 & ~mask) != 0 || ::fsync(fd_) != 0) fail_to_store("cannot write", path_);
  put_in_place(std::exchange(temporary_, {}), path_, force_);
  const Descriptor folder(::open(folder_of(path_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.get() >= 0) ::fsync(folder.get());
}

OutputFile::~OutputFile() {
  if (fd_ > STDERR_FILENO) ::close(fd_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

bool is_same_place(const std::string& a, const std::string& b) {
  if (a == b) return true;
  if (a == "-" || b == "-") return false;
  std::error_code error;
  const auto place = [&](const std::string& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, error), error);
  };
  const auto first = place(a), second = place(b);
  return !error && first == second;
}

}  // namespace terrane
