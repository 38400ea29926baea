// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/mesh/array.hpp"
#include "core/parallel.hpp"
#include "core/tin.hpp"

// What belongs to each vertex, as chains: nothing is counted or sorted, and no more memory than one link each is
// touched.
namespace terrane {

/// first[v] begins the chain of vertex v, next[i] follows item i in it. The order within a chain is unspecified.
struct Chains {
  struct Range {
    Index low, high;     // of vertices
    std::size_t before;  // items that hang at lower vertices
  };
  Array<Index> first, next;
  std::vector<Range> ranges;  // one for each thread, in order; the last one empty

  std::size_t count() const { return ranges.back().before; }
  /// Calls work(range) for each.
  template <class Work>
  void for_ranges(const Context& context, const Work& work) const {
    parallel_tasks(context, ranges.size() - 1, [&](std::size_t r) { work(ranges[r]); });
  }
};

/// Hangs some of `items` items at vertices on several threads, each of which owns a range of the vertices.
/// each(begin, end, hang) is called for consecutive ranges that make up 0 ... steps - 1 and calls hang(vertex, item),
/// for an item at most once. Quickest where steps near each other hang at near vertices: what belongs to another
/// thread's range is handed over.
template <class Each>
Chains chains(std::size_t vertices, std::size_t items, std::size_t steps, const Context& context, const Each& each) {
  struct Hung {
    Index vertex, item;
  };
  Chains made;
  made.first.resize(vertices);
  made.next.resize(items);
  const std::size_t parts = std::clamp<std::size_t>(steps / 4096, 1, std::max(1, context.threads));
  const std::size_t width = vertices / parts + 1, stride = steps / parts + 1;
  std::vector<std::vector<Hung>> handed(parts);
  std::vector<std::size_t> count(parts, 0);
  for (std::size_t r = 0; r <= parts; ++r)
    made.ranges.push_back({static_cast<Index>(std::min(vertices, r * width)),
                           static_cast<Index>(std::min(vertices, (r + 1) * width)), 0});
  parallel_tasks(context, parts, [&](std::size_t r) {
    const auto [low, high, _] = made.ranges[r];
    std::fill(made.first.begin() + low, made.first.begin() + high, none);
    std::size_t own = 0;
    each(std::min(steps, r * stride), std::min(steps, (r + 1) * stride), [&, low = low, high = high](Index v, Index i) {
      if (v < low || v >= high) return handed[r].push_back({v, i});
      made.next[i] = std::exchange(made.first[v], i);
      ++own;
    });
    count[r] = own;
  });
  parallel_tasks(context, parts, [&](std::size_t r) {
    for (const std::vector<Hung>& list : handed)
      for (const auto [v, i] : list) {
        if (v < made.ranges[r].low || v >= made.ranges[r].high) continue;
        made.next[i] = std::exchange(made.first[v], i);
        ++count[r];
      }
  });
  for (std::size_t r = 0; r < parts; ++r) made.ranges[r + 1].before = made.ranges[r].before + count[r];
  return made;
}

}  // namespace terrane
