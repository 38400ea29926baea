// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace terrane {

/// Puts edges into an order in which a triangulation takes them in O(n log^2 n) even where long ones lie side by side
/// (Shewchuk & Brown 2015): rounds of twice as many each, picked at random. Within a round the order is the one given,
/// so that what lies side by side in memory stays so (Amenta, Choi & Rote 2003). The same for the same number of edges.
template <class Edge>
void order_for_insertion(std::vector<Edge>& edges) {
  constexpr int rounds = 32;
  std::mt19937 random;
  std::vector<std::vector<Edge>> round(rounds + 1);
  for (Edge& e : edges) round[std::countr_zero(static_cast<std::uint32_t>(random()))].push_back(std::move(e));
  edges.clear();
  for (int r = rounds; r >= 0; --r) edges.insert(edges.end(), round[r].begin(), round[r].end());
}

}  // namespace terrane
