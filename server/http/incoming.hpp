// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/http/chunk_guard.hpp"
#include "server/http/request_head.hpp"
#include "server/http/spool.hpp"

namespace terrane {

/// A request whose head is here and whose body is coming. Chunks are joined on the way.
class Incoming {
 public:
  using Clock = std::chrono::steady_clock;

  Incoming(RequestHead head, SpoolBudget& budget, std::string owner, std::uint64_t max_body)
      : head(std::move(head)), body(budget, std::move(owner)), max_body_(max_body) {}

  /// Takes what belongs to the body and returns how many bytes that were. Throws HttpError 413 when the body is too
  /// large, 400 when its chunks are broken, and what Spool::append throws.
  std::size_t take(std::string_view bytes);
  bool is_complete() const;
  /// Bytes that may be read from the socket without reading into the next request; of chunks that is not known.
  std::uint64_t missing() const;

  const RequestHead head;
  Spool body;
  const Clock::time_point start = Clock::now();
  bool is_vetted = false;  // its head was seen and not answered: it takes work

 private:
  const std::uint64_t max_body_;
  ChunkGuard chunks_;
};

}  // namespace terrane
