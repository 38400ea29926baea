// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/base64.hpp"

#include <array>
#include <cstdint>

#include "core/error.hpp"

namespace terrane {

namespace {

constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

constexpr std::array<std::int8_t, 256> make_values() {
  std::array<std::int8_t, 256> values{};
  values.fill(-1);
  for (std::size_t i = 0; i < alphabet.size(); ++i)
    values[static_cast<unsigned char>(alphabet[i])] = static_cast<std::int8_t>(i);
  return values;
}

constexpr auto values = make_values();

}  // namespace

std::string decode_base64(std::string_view text, const std::string& what) {
  const auto fail = [&] {
    throw Error(ErrorKind::usage, "bad-base64", "The value of " + what + " is not base64 (RFC 4648, with padding).");
  };
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t group = 0;
  int length = 0, padding = 0;
  for (const char c : text) {
    if (c == ' ' || c == '\t' || c == '\r' || c == '\n') continue;
    const int value = values[static_cast<unsigned char>(c)];
    if (c == '=' ? length < 2 : value < 0 || padding > 0) fail();
    if (c == '=') ++padding;
    group = group << 6 | static_cast<std::uint32_t>(c == '=' ? 0 : value);
    if (++length < 4) continue;
    if (padding > 2) fail();
    const char three[3] = {static_cast<char>(group >> 16), static_cast<char>(group >> 8), static_cast<char>(group)};
    bytes.append(three, static_cast<std::size_t>(3 - padding));
    group = 0;
    length = 0;
    // A second padded group would hide where the bytes end.
    if (padding > 0) padding = 3;
  }
  if (length != 0) fail();
  return bytes;
}

std::string encode_base64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= n ? alphabet[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace terrane
