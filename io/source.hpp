// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <concepts>
#include <cstddef>
#include <functional>
#include <memory>
#include <string_view>

namespace terrane {

/// The bytes of an input, front to back, once. Bytes that lie in memory are handed out where they lie; those of a file
/// pass through one buffer of a few megabytes, which grows only where a reader asks for more in one piece than fits.
/// A view that was handed out is good until the next call.
class Source {
 public:
  /// Puts the next bytes to a place, at most as many as asked for; 0 at the end. May throw Error{input}.
  using Fill = std::function<std::size_t(char* to, std::size_t size)>;

  /// Bytes that are all there, and stay while they are read.
  Source(const std::convertible_to<std::string_view> auto& whole) : Source(std::string_view(whole), Whole()) {}
  /// `size` bytes that come in pieces, read about a block at a time. Fewer is what a file cut off in the meantime holds;
  /// more are not read.
  Source(Fill fill, std::size_t size, std::size_t block = default_block);

  std::size_t size() const { return size_; }                    // of the whole input
  std::size_t left() const { return size_ - position_; }        // not yet taken
  std::size_t position() const { return position_; }            // taken
  /// For progress: 0 to 1.
  double fraction() const { return size_ == 0 ? 1 : static_cast<double>(position_) / static_cast<double>(size_); }

  /// What comes next: `least` bytes or more, fewer only where the input ends.
  std::string_view peek(std::size_t least);
  /// Passes over bytes that were seen with peek().
  void take(std::size_t count);
  /// Takes about a block, up to and with the last of the bytes `stops` in it, so that no word or line that they end is
  /// torn; all that is left where none comes any more. Empty at the end.
  std::string_view block(std::string_view stops);
  /// Takes all that is left, in one piece.
  std::string_view rest();
  /// Takes the next bytes straight to a place; how many there were.
  std::size_t read(char* to, std::size_t count);
  /// Takes the mark that some editors put before UTF-8.
  void skip_mark();

 private:
  // Large enough that a block is worth two threads, small enough that it stays in the cache it was read into.
  static constexpr std::size_t default_block = 4 << 20;

  struct Whole {};
  Source(std::string_view whole, Whole);
  std::string_view seen() const { return {begin_, static_cast<std::size_t>(end_ - begin_)}; }
  std::size_t fill(char* to, std::size_t count);

  Fill fill_;  // null: nothing more to come than begin_ to end_
  std::unique_ptr<char[]> buffer_;
  std::size_t capacity_ = 0, size_ = 0, position_ = 0, block_ = default_block;
  const char *begin_ = nullptr, *end_ = nullptr;  // come and not yet taken
};

}  // namespace terrane
