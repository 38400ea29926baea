// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <charconv>

#include "fuzz/plan_check.hpp"
#include "server/http/chunk_guard.hpp"

namespace {

/// Whether a text is one chunked body from its first to its last byte, read as RFC 9112 writes it.
bool is_whole(std::string_view text) {
  for (;;) {
    const std::size_t line = text.find("\r\n");
    if (line == std::string_view::npos) return false;
    const std::string_view head = text.substr(0, line);
    std::size_t size = 0;
    const auto [end, error] = std::from_chars(head.data(), head.data() + head.size(), size, 16);
    const std::string_view extension = head.substr(end - head.data());
    if (error != std::errc{} || end - head.data() > 15) return false;
    if (!extension.empty() && extension[0] != ';' && extension[0] != ' ') return false;
    if (extension.size() > 257 || extension.find_first_of("\r\n") != std::string_view::npos) return false;
    text.remove_prefix(line + 2);
    if (size > text.size() || text.substr(size, 2) != "\r\n") return false;
    text.remove_prefix(size + 2);
    if (size == 0) return text.empty();
  }
}

}  // namespace

// libFuzzer on chunked bodies: the guard, which sees them in pieces, and the RFC agree about which are whole.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace terrane;
  const std::string_view body(reinterpret_cast<const char*>(data), size);
  ChunkGuard guard;
  bool accepted = true;
  for (std::size_t at = 0; accepted && at < size;) {
    const std::size_t piece = std::min<std::size_t>(1 + (size + at) % 7, size - at);
    accepted = guard.take(body.substr(at, piece), [](std::string_view) {}) == piece;
    at += piece;
  }
  fuzz::require((accepted && guard.is_complete()) == is_whole(body),
                "a body that is whole to one and not to the other");
  return 0;
}
