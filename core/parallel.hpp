// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

#include "core/context.hpp"

namespace terrane {

/// Calls task(0) ... task(count - 1) on at most context.threads threads, the caller's among them. Tasks are begun in
/// order; when it returns all have ended. The first of them in order that throws has its exception rethrown, tasks not
/// yet begun by then are left out. Throws Error{cancelled} when the context was cancelled between two tasks. Tasks must
/// not touch the context: progress and warnings are the caller's. Threads live for the call: about 30 us each.
void parallel_tasks(const Context& context, std::size_t count, const std::function<void(std::size_t)>& task);

/// Calls f(first, last) for consecutive ranges of `chunk` numbers, the last one shorter, that make up 0 ... count - 1.
/// The ranges depend on `count` and `chunk` alone, so what is kept per range is the same for any number of threads.
template <class F>
void parallel_for(const Context& context, std::size_t count, std::size_t chunk, F f) {
  const std::size_t chunks = count / chunk + (count % chunk != 0);
  parallel_tasks(context, chunks, [&](std::size_t i) { f(i * chunk, std::min(count, (i + 1) * chunk)); });
}

/// A chunk for parallel_for where what is computed does not depend on it: one for each thread.
inline std::size_t chunk_for(const Context& context, std::size_t count) {
  const std::size_t threads = static_cast<std::size_t>(std::max(1, context.threads));
  return threads == 1 ? std::max<std::size_t>(count, 1) : std::max<std::size_t>(count / threads + 1, 4096);
}

}  // namespace terrane
