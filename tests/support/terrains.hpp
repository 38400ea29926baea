// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/tin.hpp"

// Terrains for tests: random ones, the nasty pairs that overlays fail on, and small ones drawn in ASCII.
// All are deterministic: the same seed is the same terrain on every machine.
namespace terrane::support {

inline constexpr double side = 10000;  // of the square that random terrains and grids cover

/// Delaunay TIN of `points` random points on the square, its corners and about sqrt(points) points per side among them.
Tin random_terrain(int points, std::uint64_t seed);

/// n x n cells on the square; rising diagonals run from lower left to upper right.
Tin grid_terrain(int n, bool rising);

/// n x m cells of size `cell` with the lower left corner at (x, y), heights from a smooth function of the place plus
/// `lift`.
Tin patch(double x, double y, int n, int m, double cell, double lift = 0);

/// Moves vertices by up to `amount` in x and y, as far as faces stay positive; those on the square's border only with
/// `border_too`.
Tin jittered(Tin tin, double amount, bool border_too, std::uint64_t seed = 5);

/// Moves the vertices of the 4 % of the square around its centre by up to `amount` in x, y and z, as far as faces stay
/// positive: two epochs of a survey.
Tin edited(Tin tin, double amount, std::uint64_t seed = 13);

/// Moves coordinates by -1, 0 or +1 ulp; those on the square's border only with `border_too`.
Tin ulp_copy(Tin tin, bool border_too, std::uint64_t seed = 7);

Tin rotated(Tin tin, double degrees, Point2 about = {side / 2, side / 2});
Tin shifted(Tin tin, double dx, double dy, double dz = 0);

/// The Delaunay TIN of about half of a random terrain's vertices.
Tin simplified(const Tin& tin, std::uint64_t seed = 11);

/// A random terrain with 300 near-vertical steps: vertex pairs `distance` apart, 10 to 50 higher.
Tin stepped(int points, std::uint64_t seed, double distance);

/// Without the faces whose centroid `drop` accepts: holes, islands, L-shapes.
template <class Drop>
Tin without(const Tin& tin, Drop drop) {
  Tin kept{tin.vertices, {}};
  for (const Face& f : tin.faces) {
    Point2 c;
    for (const Index v : f) c.x += tin.vertices[v].x / 3, c.y += tin.vertices[v].y / 3;
    if (!drop(c)) kept.faces.push_back(f);
  }
  return canonical(kept);
}
Tin with_holes(const Tin& tin);
Tin islands(const Tin& tin);
Tin l_shape(const Tin& tin);

/// Faces and vertices in another order, faces starting elsewhere: the same surface.
Tin shuffled(const Tin& tin, std::uint64_t seed);

/// Without faces that are not strictly positive on their doubles; rotation makes some at the border.
Tin without_bad_faces(Tin tin);

struct Pair {
  std::string name;
  Tin a, b;
};

/// The pairs that broke other overlays, at the origin or at UTM coordinates (500000, 4500000). Names: nasty_pairs().
const std::vector<std::string>& nasty_pairs();
Pair nasty_pair(const std::string& name, bool utm, int points);

/// A TIN drawn with one character per lattice point, a unit apart, the first line in the north: digits and letters are
/// heights 0 to 35, '.' no sample. Cells with four samples get two faces ('rising' diagonal), with three one.
///   drawn("111\n"
///         "121\n"
///         "111")
Tin drawn(std::string_view picture, double unit = 1, Point2 lower_left = {0, 0});

}  // namespace terrane::support
