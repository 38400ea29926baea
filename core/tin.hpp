// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

// A triangulated surface as a value: flat arrays, nothing else. The coordinate reference system travels outside.
namespace terrane {

class Context;

using Index = std::int32_t;
inline constexpr Index none = -1;

struct Point2 {
  double x = 0, y = 0;
  bool operator==(const Point2&) const = default;
};

struct Point {
  double x = 0, y = 0, z = 0;
  bool operator==(const Point&) const = default;
};

/// Three vertex indices, counter-clockwise seen from above.
using Face = std::array<Index, 3>;

/// A TIN: single-valued in z over its domain, the union of its faces in plan. The domain may have holes, islands and
/// several components. A wall is a vertical face: two of its corners have identical x and y.
/// Units are those of the CRS the surface is said to be in; the core never asks which.
struct Tin {
  std::vector<Point> vertices;
  std::vector<Face> faces;
  bool operator==(const Tin&) const = default;
};

inline Point2 plan(const Point& p) { return {p.x, p.y}; }

/// True for a vertical face: at least two corners at one place in plan.
inline bool is_wall(const Tin& tin, const Face& f) {
  const Point2 a = plan(tin.vertices[f[0]]), b = plan(tin.vertices[f[1]]), c = plan(tin.vertices[f[2]]);
  return a == b || b == c || c == a;
}

struct Box {
  double xmin, ymin, xmax, ymax;
  bool operator==(const Box&) const = default;
};

/// The smallest box around all vertices in plan; inverted infinities for an empty TIN.
Box bounds(const Tin& tin);

/// The lowest and the highest vertex; both 0 for an empty TIN.
struct HeightSpan {
  double low = 0, high = 0;
};
HeightSpan height_span(const Tin& tin);

/// The same surface in the one order that does not depend on the order given: vertices along a Hilbert curve of their
/// plan position (ties by z), faces starting at their lowest vertex and sorted, unused vertices dropped. O(n log n);
/// a pass or two, and no other memory, where nothing is out of order.
Tin canonical(Tin tin, const Context& context);
Tin canonical(Tin tin);
Tin canonical(std::span<const Point> vertices, std::vector<Face> faces, const Context& context);
/// The same of parts that lie apart, without those faces whose first corner is none. Renumbers `faces`.
Tin canonical(std::span<const Point2> points, std::span<const double> z, std::span<Face> faces, const Context& context);

}  // namespace terrane
