// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/source.hpp"

#include <algorithm>
#include <cstring>

#include "io/text.hpp"

namespace terrane {

Source::Source(std::string_view whole, Whole)
    : size_(whole.size()), begin_(whole.data()), end_(whole.data() + whole.size()) {}

Source::Source(Fill fill, std::size_t size, std::size_t block)
    : fill_(std::move(fill)), size_(size), block_(std::max<std::size_t>(1, block)) {}

/// Bytes that are not in the buffer yet; a file that ends early ends the input.
std::size_t Source::fill(char* to, std::size_t count) {
  std::size_t got = 0;
  while (fill_ && got < count) {
    const std::size_t more = fill_(to + got, count - got);
    got += more;
    if (more == 0) fill_ = nullptr;
  }
  return got;
}

std::string_view Source::peek(std::size_t least) {
  const std::string_view kept = seen();
  least = std::min(least, left());
  if (kept.size() >= least || !fill_) return kept;
  const std::size_t needed = std::min(std::max(least, block_), left());
  if (needed > capacity_) {
    auto larger = std::make_unique_for_overwrite<char[]>(needed);
    if (!kept.empty()) std::memcpy(larger.get(), kept.data(), kept.size());
    buffer_ = std::move(larger);
    capacity_ = needed;
  } else if (!kept.empty()) {
    std::memmove(buffer_.get(), kept.data(), kept.size());
  }
  begin_ = buffer_.get();
  end_ = begin_ + kept.size() + fill(buffer_.get() + kept.size(), needed - kept.size());
  return seen();
}

void Source::take(std::size_t count) {
  begin_ += count;
  position_ += count;
}

std::string_view Source::block(std::string_view stops) {
  for (std::size_t least = block_;; least *= 2) {
    std::string_view view = peek(least).substr(0, least);
    if (view.size() < left() && !(view.size() < least)) {
      const std::size_t stop = view.find_last_of(stops);
      if (stop == std::string_view::npos) continue;
      view = view.substr(0, stop + 1);
    }
    take(view.size());
    return view;
  }
}

std::string_view Source::rest() {
  const std::string_view view = peek(left());
  take(view.size());
  return view;
}

std::size_t Source::read(char* to, std::size_t count) {
  count = std::min(count, left());
  const std::size_t kept = std::min(count, seen().size());
  if (kept != 0) std::memcpy(to, begin_, kept);
  take(kept);
  const std::size_t more = fill(to + kept, count - kept);
  position_ += more;
  return kept + more;
}

void Source::skip_mark() {
  const std::string_view head = peek(3);
  take(head.size() - without_mark(head).size());
}

}  // namespace terrane
