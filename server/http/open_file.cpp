// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/open_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/error.hpp"

namespace terrane {

namespace {

[[noreturn]] void fail(const std::string& what) {
  throw Error(ErrorKind::internal, "file-not-readable", what + ": " + std::strerror(errno));
}

}  // namespace

OpenFile::OpenFile(const std::string& path) : file_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW)) {
  if (file_ < 0) fail(path);
  struct stat status;
  if (fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) {
    close(file_);
    fail(path + " is no plain file");
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

OpenFile::~OpenFile() { close(file_); }

std::size_t OpenFile::read(std::uint64_t offset, char* to, std::size_t count) const {
  std::size_t done = 0;
  while (done < count) {
    const ssize_t n = pread(file_, to + done, count - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("reading a file");
    if (n == 0) break;
    done += static_cast<std::size_t>(n);
  }
  return done;
}

std::string OpenFile::text(std::uint64_t most) const {
  if (size_ > most) throw Error(ErrorKind::internal, "file-too-large", "a file is larger than it can be");
  std::string all(size_, '\0');
  all.resize(read(0, all.data(), all.size()));
  return all;
}

}  // namespace terrane
