// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/outgoing.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

namespace terrane {

long Outgoing::send_some(int socket) {
  char block[64 * 1024];
  const bool from_bytes = sent_ < bytes_.size();
  if (!from_bytes && !file_) return 0;
  const std::size_t size =
      from_bytes ? bytes_.read(sent_, block, sizeof block)
                 : file_->file->read(file_->offset, block,
                                     static_cast<std::size_t>(std::min<std::uint64_t>(sizeof block, file_->size)));
  if (size == 0 && (from_bytes || file_->size > 0)) return -1;  // the file was cut: the answer cannot be completed
  const ssize_t n = size == 0 ? 0 : send(socket, block, size, MSG_NOSIGNAL | MSG_DONTWAIT);
  if (n < 0) return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR ? 0 : -1;
  if (from_bytes) {
    sent_ += static_cast<std::uint64_t>(n);
  } else {
    file_->offset += static_cast<std::uint64_t>(n);
    file_->size -= static_cast<std::uint64_t>(n);
  }
  if (file_ && file_->size == 0) file_.reset();
  return n;
}

void Outgoing::clear() {
  bytes_.clear();
  sent_ = 0;
  file_.reset();
}

}  // namespace terrane
