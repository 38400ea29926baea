// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
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

void write_all(int fd, std::string_view bytes, const std::string& path) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail_to_store("cannot write", path);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
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

std::string read_file(const std::string& path) {
  const Descriptor file(path == "-" ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) fail(ErrorKind::input, "not-readable", "cannot read", path);
  struct stat facts {};
  std::string bytes;
  if (::fstat(file.get(), &facts) == 0 && S_ISREG(facts.st_mode))
    bytes.reserve(static_cast<std::size_t>(facts.st_size) + 1);
  std::vector<char> block(1 << 20);
  for (;;) {
    const ssize_t n = ::read(file.get(), block.data(), block.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(ErrorKind::input, "not-readable", "cannot read", path);
    if (n == 0) return bytes;
    bytes.append(block.data(), static_cast<std::size_t>(n));
  }
}

void refuse_existing(const std::string& path, bool force) {
  struct stat facts {};
  if (path.empty() || path == "-" || ::stat(path.c_str(), &facts) != 0) return;
  if (S_ISDIR(facts.st_mode)) throw Error(ErrorKind::usage, "output-exists", "'" + path + "' is a folder");
  if (S_ISREG(facts.st_mode) && !force)
    throw Error(ErrorKind::usage, "output-exists", "'" + path + "' exists; say --force to replace it");
}

void store_file(const std::string& path, std::string_view bytes, bool force) {
  struct stat facts {};
  const bool exists = path != "-" && ::stat(path.c_str(), &facts) == 0;
  if (path == "-" || (exists && !S_ISREG(facts.st_mode))) {
    const Descriptor out(path == "-" ? STDOUT_FILENO : ::open(path.c_str(), O_WRONLY | O_CLOEXEC));
    if (out.get() < 0) fail_to_store("cannot write", path);
    write_all(out.get(), bytes, path);
    return;
  }
  std::string temporary = folder_of(path) + "/." + file_name(path) + ".XXXXXX";
  {
    const Descriptor out(::mkostemp(temporary.data(), O_CLOEXEC));
    if (out.get() < 0) fail_to_store("cannot write", path);
    try {
      const mode_t mask = ::umask(0);
      ::umask(mask);
      write_all(out.get(), bytes, path);
      if (::fchmod(out.get(), 0666 & ~mask) != 0 || ::fsync(out.get()) != 0)
        fail_to_store("cannot write", path);
    } catch (...) {
      ::unlink(temporary.c_str());
      throw;
    }
  }
  put_in_place(temporary, path, force);
  const Descriptor folder(::open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.get() >= 0) ::fsync(folder.get());
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
