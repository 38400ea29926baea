// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/context.hpp"
#include "core/plan/noding.hpp"
#include "core/tin.hpp"

// Surfaces made from nothing: planes and ramps over rectangles, level areas inside ellipses and free-form curves.
// `max_edge`, where it is above 0, is a bound of the length in plan of every edge; 0 asks for as few faces as there can
// be. What would have more than 20 million faces is refused: Error{usage, "max-edge"}.
namespace terrane {

/// The rectangle, at height z_xmin along its left side and z_xmax along its right one, linear between: two faces, or
/// equal cells with alternating diagonals. Precondition: the box has an area.
Tin rectangle(const Box& box, double z_xmin, double z_xmax, double max_edge);

/// `samples` corners of an ellipse, counter-clockwise, evenly in its parameter, the first at the end of the major axis:
/// centre + (cos(2 pi n / samples) major / 2, sin(2 pi n / samples) minor / 2), turned by `azimuth` degrees clockwise:
/// at 0 the major axis lies along x and the minor one points north. Axes are full lengths. Quarters are exact.
/// samples >= 3.
std::vector<Point2> ellipse(Point2 centre, double major, double minor, double azimuth, int samples);

/// `samples` places on the closed curve through the points: the periodic cubic spline, twice continuously
/// differentiable, over the centripetal parameter (the square root of the distance between neighbours; Lee, 1989), for
/// which it neither overshoots nor loops where distances differ as much as it does over others. With at least as many
/// samples as points the points are among them, bit for bit, the others spread evenly over the parameter between;
/// with fewer all are spread evenly from the first point on. Repeated points in a row, and a last that repeats the
/// first, count once. Throws Error{input, "too-few-points"} below three. O(points + samples).
std::vector<Point2> closed_spline(std::span<const Point2> points, int samples);

/// The ring without repeated points in a row; a last that repeats the first goes too.
std::vector<Point2> without_repeats(std::span<const Point2> ring);

/// Where a closed ring first crosses or touches itself. None for a simple one.
std::optional<Crossing> self_contact(std::span<const Point2> ring, const Context& context);

/// What a simple ring encloses, level at z: the constrained Delaunay triangulation of the ring alone, or, with
/// max_edge, of the ring with its edges divided evenly and a regular lattice inside. Throws Error{input, "flat-ring"}
/// where all corners lie on a line. O(n log n).
Tin level_area(std::span<const Point2> ring, double z, double max_edge, const Context& context);

}  // namespace terrane
