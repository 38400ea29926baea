// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/context.hpp"
#include "core/tin.hpp"

// Straight edges as they come, crossing and touching each other, made to meet at their ends only.
namespace terrane {

/// An edge between two places, of something the caller knows by its number.
struct NodedEdge {
  Index from, to, owner;
  bool operator==(const NodedEdge&) const = default;
};

struct Crossing {
  Point2 at;
  Index a, b;  // numbers of the edges, a < b
};

/// Places where edges meet other than at a common end: they cross, an end of one lies inside another, or they run along
/// each other. Decided exactly; `at` is rounded where they cross. Each pair once, by (a, b); two for edges that run
/// along each other. At most `limit`. Throws Error{limit} above ten million. About 1 us per edge where edges are short.
std::vector<Crossing> find_crossings(std::span<const Point2> points, std::span<const NodedEdge> edges,
                                     std::size_t limit, const Context& context);

struct Noded {
  std::vector<Point2> points;    // those given first, each place once; then the crossings
  std::vector<NodedEdge> edges;  // of the same owners, directed as they were
};

/// Splits the edges wherever they meet. A crossing becomes the nearest double, which bends the edges by an ulp; what
/// that makes meet is split in turn. Equal points become one. Edges without length vanish. Throws Error{input,
/// "rounding"} naming a place where that does not come to an end.
Noded node_edges(std::vector<Point2> points, std::vector<NodedEdge> edges, const Context& context);

}  // namespace terrane
