// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string_view>

namespace terrane {

/// Watches the bytes of a chunked body (RFC 9112, 7.1) on their way to the library, which takes a size of -2 for an
/// endless chunk and a missing line end for the end of the body. O(1) memory; trailers are refused.
class ChunkGuard {
 public:
  /// False as soon as a byte breaks the framing.
  bool accepts(std::string_view bytes);
  /// True once the last chunk and its empty line have passed.
  bool is_complete() const { return state_ == State::complete; }

 private:
  enum class State { size, extension, size_end, data, data_cr, data_lf, last_cr, last_lf, complete };
  bool take(char c);

  State state_ = State::size;
  std::uint64_t left_ = 0;  // of the chunk
  int digits_ = 0, extension_length_ = 0;
};

}  // namespace terrane
