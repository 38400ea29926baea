// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "core/tin.hpp"

namespace terrane {

/// Triangles by the error of their worst sample, largest first to within 1 part in 256: buckets of the upper bits of a
/// float, newest first within a bucket. Every step O(1); what is taken depends on the order of calls alone.
class GreedyQueue {
 public:
  GreedyQueue() : head_(buckets, none), words_(buckets / 64, 0) {}

  void resize(std::size_t triangles) { links_.resize(triangles); }

  /// Puts triangle t at `error`, or takes it out where error <= 0.
  void set(Index t, float error) {
    Link& link = links_[t];
    if (link.bucket != none) unlink(t);
    if (!(error > 0)) return;
    link.bucket = static_cast<Index>(std::bit_cast<std::uint32_t>(error) >> shift);
    link.previous = none;
    link.next = head_[link.bucket];
    if (link.next != none) links_[link.next].previous = t;
    head_[link.bucket] = t;
    words_[link.bucket / 64] |= std::uint64_t{1} << link.bucket % 64;
    if (link.bucket / 64 > top_) top_ = link.bucket / 64;
  }

  /// The triangle at the top, or none.
  Index top() {
    while (top_ >= 0 && words_[top_] == 0) --top_;
    return top_ < 0 ? none : head_[top_ * 64 + 63 - std::countl_zero(words_[top_])];
  }

  /// The error of the topmost bucket, 0 when there is none.
  float top_error() {
    const Index t = top();
    return t == none ? 0 : std::bit_cast<float>(static_cast<std::uint32_t>(links_[t].bucket) << shift);
  }

 private:
  struct Link {
    Index bucket = none, previous = none, next = none;
  };
  static constexpr int shift = 15;
  static constexpr std::size_t buckets = std::size_t{1} << (31 - shift);

  void unlink(Index t) {
    Link& link = links_[t];
    if (link.next != none) links_[link.next].previous = link.previous;
    if (link.previous != none) {
      links_[link.previous].next = link.next;
    } else {
      head_[link.bucket] = link.next;
      if (link.next == none) words_[link.bucket / 64] &= ~(std::uint64_t{1} << link.bucket % 64);
    }
    link.bucket = none;
  }

  std::vector<Index> head_;
  std::vector<std::uint64_t> words_;
  std::vector<Link> links_;
  int top_ = -1;
};

}  // namespace terrane
