// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "core/clip.hpp"
#include "support/small_mesh.hpp"

// What a clip must satisfy whatever the surface and the region.
namespace terrane::support {

Line ring(std::initializer_list<Point2> corners);

/// A star-shaped ring of n corners around a centre, at random distances.
Line star(Point2 centre, double least, double most, int n, Random& random);

/// Does the place lie inside by the parity of each ring, in plain doubles? `near`: within `distance` of a ring, where
/// that says nothing.
bool inside(const std::vector<Polygon>& polygons, Point2 place);
bool near_border(const std::vector<Polygon>& polygons, Point2 place, double distance);

/// Faces of both, vertices that are equal made one.
Tin put_together(const Tin& a, const Tin& b);

/// The area in space of the walls.
double wall_area(const Tin& tin);

/// What is wrong with the two clips of a surface: their meshes, heights at random places, areas, vertices, what they
/// make when they are put side by side and when they are merged. Empty when all is right.
std::string wrong_with_clips(const Tin& surface, const std::vector<Polygon>& polygons, std::uint64_t seed = 1);

}  // namespace terrane::support
