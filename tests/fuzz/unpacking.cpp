// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/unpacking.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "fuzz/require.hpp"

namespace {

struct TooLarge {};

/// What a packed body holds; nothing when it is broken.
std::optional<std::string> unpacked(const char* coding, std::string_view body, std::size_t piece) {
  constexpr std::size_t most = 1 << 20;
  const auto unpacker = terrane::unpacker(coding);
  std::string out;
  const auto sink = [&](std::string_view text) {
    if ((out += text).size() > most) throw TooLarge();
  };
  for (; !body.empty(); body.remove_prefix(std::min(piece, body.size())))
    if (!unpacker->add(body.substr(0, piece), sink)) return std::nullopt;
  return unpacker->is_complete() ? std::optional(out) : std::nullopt;
}

}  // namespace

// libFuzzer on packed bodies, the first byte of which says in which coding: in pieces or whole they hold the same. Of
// those that grow too large to go on it is not known whether they are broken further on.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const char* coding = std::array{"gzip", "deflate", "zstd"}[data[0] % 3];
  const std::string_view body(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    terrane::fuzz::require(unpacked(coding, body, body.size()) == unpacked(coding, body, 1 + size % 7),
                           "a packed body holds one thing in pieces and another whole");
  } catch (TooLarge) {
  }
  return 0;
}
