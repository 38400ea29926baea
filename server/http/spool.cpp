// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/spool.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/error.hpp"
#include "server/http/http_limits.hpp"
#include "server/http/message.hpp"

namespace terrane {

namespace {

[[noreturn]] void fail(const std::string& what) {
  if (errno == ENOSPC || errno == EDQUOT || errno == EFBIG) {
    throw Error(ErrorKind::storage_full, "storage-full", "There is no room left to keep this request.");
  }
  if (errno == EMFILE || errno == ENFILE) {
    throw Error(ErrorKind::busy, "busy", "Too many requests are being received; send this one again in a few seconds.");
  }
  throw Error(ErrorKind::internal, "spool-failed", what + ": " + std::strerror(errno));
}

int open_nameless(const std::string& folder) {
  int file = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file < 0 && (errno == EOPNOTSUPP || errno == EISDIR)) {  // not every file system can
    std::string name = folder + "/.spool-XXXXXX";
    file = mkostemp(name.data(), O_CLOEXEC);
    if (file >= 0) unlink(name.c_str());
  }
  if (file < 0) fail("making a file in " + folder);
  return file;
}

}  // namespace

void SpoolBudget::take(const std::string& address, std::size_t count) {
  const std::lock_guard lock(mutex_);
  if (used_ + count > all_) {
    throw Error(ErrorKind::busy, "busy", "Too much is being received; send the request again in a few seconds.");
  }
  const auto found = used_by_.find(address);
  if ((found == used_by_.end() ? 0 : found->second) + count > of_one_) {
    throw HttpError(429, "too-much-at-once",
                    "Your address has " + std::to_string(of_one_) +
                        " bytes of requests under way; send this one when others are answered.",
                    {{"Retry-After", "5"}});
  }
  used_ += count;
  used_by_[address] += count;
}

void SpoolBudget::give_back(const std::string& address, std::size_t count) {
  if (count == 0) return;
  const std::lock_guard lock(mutex_);
  used_ -= count;
  const auto found = used_by_.find(address);
  found->second -= count;
  if (found->second == 0) used_by_.erase(found);
}

bool SpoolBudget::take_memory(std::size_t count) {
  const std::lock_guard lock(mutex_);
  if (memory_used_ + count > http_limits::spools_in_memory) return false;
  memory_used_ += count;
  return true;
}

void SpoolBudget::give_back_memory(std::size_t count) {
  const std::lock_guard lock(mutex_);
  memory_used_ -= count;
}

std::string spool_owner(const std::string& address) {
  in6_addr parts;
  if (inet_pton(AF_INET6, address.c_str(), &parts) != 1 || IN6_IS_ADDR_V4MAPPED(&parts)) return address;
  return std::string(reinterpret_cast<const char*>(parts.s6_addr), 8);
}

void Spool::append(std::string_view bytes) {
  if (bytes.empty()) return;
  budget_->take(owner_, bytes.size());
  try {
    const bool fits = file_ < 0 && memory_.size() + bytes.size() <= http_limits::spool_in_memory;
    if (fits && budget_->take_memory(bytes.size())) {
      memory_ += bytes;
    } else {
      if (file_ < 0) move_to_file();
      write(size_, bytes);
    }
  } catch (...) {
    budget_->give_back(owner_, bytes.size());
    throw;
  }
  size_ += bytes.size();
}

void Spool::move_to_file() {
  file_ = open_nameless(budget_->folder());
  try {
    write(0, memory_);
  } catch (...) {
    close(file_);
    file_ = -1;
    throw;
  }
  budget_->give_back_memory(memory_.size());
  memory_ = std::string();
}

void Spool::write(std::uint64_t offset, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail("writing a file in " + budget_->folder());
    bytes.remove_prefix(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
}

std::size_t Spool::read(std::uint64_t offset, char* to, std::size_t count) const {
  count = static_cast<std::size_t>(std::min<std::uint64_t>(count, size_ - std::min(offset, size_)));
  if (file_ < 0) {
    std::copy_n(memory_.data() + offset, count, to);
    return count;
  }
  for (std::size_t done = 0; done < count;) {
    const ssize_t n = pread(file_, to + done, count - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail("reading a file in " + budget_->folder());
    done += static_cast<std::size_t>(n);
  }
  return count;
}

void Spool::clear() {
  budget_->give_back(owner_, static_cast<std::size_t>(size_));
  budget_->give_back_memory(memory_.size());
  if (file_ >= 0) close(file_);
  memory_ = std::string();
  file_ = -1;
  size_ = 0;
}

}  // namespace terrane
