// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "core/tin.hpp"

// Small valid meshes of any points whatever, without CGAL and fast, for tests that need a million of them.
namespace terrane::support {

using Random = std::mt19937_64;

/// The same on every machine, which std distributions are not.
inline double uniform(Random& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}
inline int below(Random& random, int n) { return static_cast<int>(random() % static_cast<std::uint64_t>(n)); }

/// A triangulation of the convex hull of the points by a sweep: valid by construction, full of slivers. Of points at
/// one place the first is taken. Without faces when all points lie on a line.
Tin swept(const std::vector<Point>& points);

/// Turns the diagonals of strictly convex quadrilaterals: `flips` random ones, one, or all that are not Delaunay.
Tin flipped(Tin tin, int flips, Random& random);
void flip(Tin& tin, std::size_t which);  // 3 * face + corner, modulo their number
Tin made_delaunay(Tin tin);

}  // namespace terrane::support
