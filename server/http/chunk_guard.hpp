// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

namespace terrane {

/// Takes the chunks of a body (RFC 9112, 7.1) apart as they come. The library would take a size of -2 for an endless
/// chunk and a missing line end for the end of the body. O(1) memory; trailers are refused.
class ChunkGuard {
 public:
  /// Hands on the data among the bytes and returns how many of them belong to the body: fewer than there are when it
  /// ends among them. Nothing as soon as a byte breaks the framing.
  std::optional<std::size_t> take(std::string_view bytes, const std::function<void(std::string_view)>& data);
  /// True once the last chunk and its empty line have passed.
  bool is_complete() const { return state_ == State::complete; }

 private:
  enum class State { size, extension, size_end, data, data_cr, data_lf, last_cr, last_lf, complete };
  bool take_framing(char c);

  State state_ = State::size;
  std::uint64_t left_ = 0;  // of the chunk
  int digits_ = 0, extension_length_ = 0;
};

}  // namespace terrane
