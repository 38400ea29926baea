// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include "core/context.hpp"
#include "core/parallel.hpp"
#include "io/format.hpp"

// Meshes as rows of a file: one vertex or face each, thousands to a block, the blocks on several threads.
namespace terrane {

/// Hands rows on in their order, whoever formats them. Memory: one block for each thread.
class RowWriter {
 public:
  RowWriter(const Sink& sink, std::size_t all_rows, Context& context)
      : sink_(sink), context_(context), all_(all_rows), buffers_(std::max(1, context.threads)) {}

  /// `put(to, i)` puts row i, of at most `row_size` bytes, and returns where it ends; called on several threads.
  template <class Put>
  void write(std::size_t count, std::size_t row_size, const Put& put) {
    const std::size_t rows = block_size / row_size;
    std::vector<std::string_view> texts(buffers_.size());
    for (std::size_t first = 0; first < count; first += rows * texts.size()) {
      context_.progress("write", static_cast<double>(done_) / static_cast<double>(all_));
      parallel_tasks(context_, texts.size(), [&](std::size_t k) {
        const std::size_t begin = std::min(count, first + k * rows), end = std::min(count, begin + rows);
        if (begin != end && !buffers_[k]) buffers_[k] = std::make_unique_for_overwrite<char[]>(block_size);
        char* to = buffers_[k].get();
        for (std::size_t i = begin; i < end; ++i) to = put(to, i);
        texts[k] = {buffers_[k].get(), static_cast<std::size_t>(to - buffers_[k].get())};
      });
      for (std::string_view text : texts)
        if (!text.empty()) sink_(text);
      done_ += std::min(count - first, rows * texts.size());
    }
  }

 private:
  static constexpr std::size_t block_size = 1 << 20;

  const Sink& sink_;
  Context& context_;
  std::size_t all_, done_ = 0;
  std::vector<std::unique_ptr<char[]>> buffers_;
};

/// Room for `more` items that were read from `bytes` bytes, and where the list must grow, for as many again as the bytes
/// still to come would hold, and a quarter more: lists need not move, and pages that are never written cost nothing.
template <class T>
void make_room(std::vector<T>& list, std::size_t more, std::size_t bytes, std::size_t bytes_to_come) {
  const std::size_t needed = list.size() + more;
  if (needed <= list.capacity()) return;
  const double items_per_byte = static_cast<double>(more) / static_cast<double>(bytes);
  list.reserve(needed + static_cast<std::size_t>(1.25 * items_per_byte * static_cast<double>(bytes_to_come)));
}

}  // namespace terrane
