// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/http/message.hpp"
#include "server/http/spool.hpp"

namespace terrane {

/// What is left of an answer: bytes, and after them perhaps a file. Sent piece by piece as the client takes it.
class Outgoing {
 public:
  Outgoing(SpoolBudget& budget, std::string owner) : bytes_(budget, std::move(owner)) {}

  void append(std::string_view bytes) { bytes_.append(bytes); }
  void append(FileBody file) { file_ = std::move(file); }
  bool is_empty() const { return sent_ == bytes_.size() && !file_; }
  /// Sends what the socket takes at once, one block at most; bytes sent, 0 when it takes none, -1 when it is broken.
  long send_some(int socket);
  void clear();

 private:
  Spool bytes_;
  std::uint64_t sent_ = 0;  // of bytes_
  std::optional<FileBody> file_;
};

}  // namespace terrane
