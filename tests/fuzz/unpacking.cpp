// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "fuzz/require.hpp"
#include "server/unpacking.hpp"

namespace {

constexpr std::size_t most = 1 << 20;

/// What a packed body holds, up to a limit; nothing when it is broken.
std::optional<std::string> unpacked(const char* coding, std::string_view body, std::size_t piece) {
  const auto unpacker = terrane::unpacker(coding);
  std::string out;
  struct Enough {};
  try {
    for (; !body.empty(); body.remove_prefix(std::min(piece, body.size()))) {
      const auto sink = [&](std::string_view text) {
        if ((out += text).size() > most) throw Enough();
      };
      if (!unpacker->add(body.substr(0, piece), sink)) return std::nullopt;
    }
  } catch (Enough) {
    return out.substr(0, most);
  }
  return unpacker->is_complete() ? std::optional(out) : std::nullopt;
}

}  // namespace

// libFuzzer on packed bodies, the first byte of which says in which coding: in pieces or whole they hold the same, where
// both are taken. Of broken frames libzstd takes some that come at once and not in pieces.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const char* coding = std::array{"gzip", "deflate", "zstd"}[data[0] % 3];
  const std::string_view body(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto whole = unpacked(coding, body, body.size()), pieces = unpacked(coding, body, 1 + size % 7);
  terrane::fuzz::require(!whole || !pieces || *whole == *pieces,
                         "a packed body holds one thing in pieces and another whole");
  return 0;
}
