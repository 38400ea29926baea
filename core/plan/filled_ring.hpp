// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/context.hpp"
#include "core/tin.hpp"

namespace terrane {

struct PlainMesh {
  std::vector<Point2> points;
  std::vector<Face> faces;  // counter-clockwise, positive
};

/// The constrained Delaunay triangulation of what a simple ring encloses. With max_edge above 0 a lattice of
/// equilateral triangles is laid inside, and edges that are still longer are halved, the longest first, until none is;
/// edges of the ring must not be. No faces where the ring has no area. Deterministic.
PlainMesh fill_ring(std::span<const Point2> ring, double max_edge, const Context& context);

}  // namespace terrane
