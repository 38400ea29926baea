// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/chunk_guard.hpp"

#include <algorithm>
#include <cstddef>

namespace terrane {

namespace {

constexpr int max_digits = 15;  // far beyond any body, far from an overflow
constexpr int max_extension = 256;

int hexadecimal(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

std::optional<std::size_t> ChunkGuard::take(std::string_view bytes, const std::function<void(std::string_view)>& data) {
  std::size_t at = 0;
  while (at < bytes.size() && state_ != State::complete) {
    if (state_ == State::data) {
      const std::size_t passing = static_cast<std::size_t>(std::min<std::uint64_t>(left_, bytes.size() - at));
      data(bytes.substr(at, passing));
      at += passing;
      left_ -= passing;
      if (left_ == 0) state_ = State::data_cr;
    } else if (!take_framing(bytes[at++])) {
      return std::nullopt;
    }
  }
  return at;
}

bool ChunkGuard::take_framing(char c) {
  const auto move_on = [&](bool expected, State next) {
    if (expected) state_ = next;
    return expected;
  };
  switch (state_) {
    case State::size:
      if (const int digit = hexadecimal(c); digit >= 0) {
        left_ = left_ * 16 + static_cast<std::uint64_t>(digit);
        return ++digits_ <= max_digits;
      }
      if (digits_ == 0) return false;
      return c == '\r' ? move_on(true, State::size_end) : move_on(c == ';' || c == ' ', State::extension);
    case State::extension:
      if (c == '\r') return move_on(true, State::size_end);
      return ++extension_length_ <= max_extension && c != '\n';
    case State::size_end:
      digits_ = extension_length_ = 0;
      return move_on(c == '\n', left_ == 0 ? State::last_cr : State::data);
    case State::data_cr:
      return move_on(c == '\r', State::data_lf);
    case State::data_lf:
      return move_on(c == '\n', State::size);
    case State::last_cr:
      return move_on(c == '\r', State::last_lf);
    case State::last_lf:
      return move_on(c == '\n', State::complete);
    case State::data:
    case State::complete:
      return false;
  }
  return false;
}

}  // namespace terrane
