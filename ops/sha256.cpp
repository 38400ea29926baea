// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/sha256.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace terrane {
namespace {

using Words = std::array<std::uint32_t, 64>;

// The constants are defined as the first 32 bits of the fractional parts of the roots of the first primes: computed
// exactly in integers instead of copied.
std::uint32_t root_fraction(std::uint64_t prime, int degree) {
  // Largest r with r^degree <= prime * 2^(32 * degree); its low 32 bits are the fraction.
  unsigned __int128 low = 0, high = static_cast<unsigned __int128>(1) << 37;
  const auto not_above = [&](unsigned __int128 r) {
    if (degree == 2) return r * r <= (static_cast<unsigned __int128>(prime) << 64);
    const unsigned __int128 square = r * r;  // below 2^74
    // r^3 <= prime * 2^96  <=>  floor(square * r / 2^64) compared with prime * 2^32, exactly
    const unsigned __int128 high_part = (square >> 64) * r, low_part = (square & ~std::uint64_t{0}) * r;
    const unsigned __int128 top = high_part + (low_part >> 64);
    const unsigned __int128 limit = static_cast<unsigned __int128>(prime) << 32;
    return top < limit || (top == limit && static_cast<std::uint64_t>(low_part) == 0);
  };
  while (high - low > 1) {
    const unsigned __int128 middle = low + (high - low) / 2;
    (not_above(middle) ? low : high) = middle;
  }
  return static_cast<std::uint32_t>(low);
}

struct Constants {
  Words k{};
  std::array<std::uint32_t, 8> start{};
  Constants() {
    int count = 0;
    for (std::uint64_t n = 2; count < 64; ++n) {
      bool prime = true;
      for (std::uint64_t d = 2; d * d <= n; ++d) prime = prime && n % d != 0;
      if (!prime) continue;
      if (count < 8) start[count] = root_fraction(n, 2);
      k[count++] = root_fraction(n, 3);
    }
  }
};

void compress(std::array<std::uint32_t, 8>& state, const unsigned char* block, const Words& k) {
  Words w;
  for (int i = 0; i < 16; ++i)
    w[i] = std::uint32_t{block[4 * i]} << 24 | std::uint32_t{block[4 * i + 1]} << 16 |
           std::uint32_t{block[4 * i + 2]} << 8 | block[4 * i + 3];
  for (int i = 16; i < 64; ++i) {
    const std::uint32_t s0 = std::rotr(w[i - 15], 7) ^ std::rotr(w[i - 15], 18) ^ (w[i - 15] >> 3);
    const std::uint32_t s1 = std::rotr(w[i - 2], 17) ^ std::rotr(w[i - 2], 19) ^ (w[i - 2] >> 10);
    w[i] = w[i - 16] + s0 + w[i - 7] + s1;
  }
  auto [a, b, c, d, e, f, g, h] = state;
  for (int i = 0; i < 64; ++i) {
    const std::uint32_t s1 = std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25);
    const std::uint32_t t1 = h + s1 + ((e & f) ^ (~e & g)) + k[i] + w[i];
    const std::uint32_t s0 = std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22);
    const std::uint32_t t2 = s0 + ((a & b) ^ (a & c) ^ (b & c));
    h = g, g = f, f = e, e = d + t1, d = c, c = b, b = a, a = t1 + t2;
  }
  const std::array<std::uint32_t, 8> add = {a, b, c, d, e, f, g, h};
  for (int i = 0; i < 8; ++i) state[i] += add[i];
}

}  // namespace

std::string sha256(std::string_view bytes) {
  static const Constants constants;
  auto state = constants.start;
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const std::size_t whole = bytes.size() / 64;
  for (std::size_t i = 0; i < whole; ++i) compress(state, data + 64 * i, constants.k);

  unsigned char tail[128] = {};
  const std::size_t rest = bytes.size() - 64 * whole;
  if (rest) std::memcpy(tail, data + 64 * whole, rest);
  tail[rest] = 0x80;
  const std::size_t blocks = rest < 56 ? 1 : 2;
  const std::uint64_t bits = std::uint64_t{bytes.size()} * 8;
  for (int i = 0; i < 8; ++i) tail[64 * blocks - 1 - i] = static_cast<unsigned char>(bits >> (8 * i));
  for (std::size_t i = 0; i < blocks; ++i) compress(state, tail + 64 * i, constants.k);

  std::string text;
  for (std::uint32_t word : state)
    for (int shift = 28; shift >= 0; shift -= 4) text += "0123456789abcdef"[word >> shift & 15];
  return text;
}

}  // namespace terrane
