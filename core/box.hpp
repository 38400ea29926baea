// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "core/context.hpp"
#include "core/tin.hpp"

namespace terrane {

/// No box: what others are joined to.
inline constexpr Box no_box = {INFINITY, INFINITY, -INFINITY, -INFINITY};

/// The smallest box around two, or around a box and a place.
inline Box around(const Box& a, const Box& b) {
  return {std::min(a.xmin, b.xmin), std::min(a.ymin, b.ymin), std::max(a.xmax, b.xmax), std::max(a.ymax, b.ymax)};
}
inline Box around(const Box& box, Point2 p) { return around(box, Box{p.x, p.y, p.x, p.y}); }

/// Have they a place in common?
inline bool touches(const Box& a, const Box& b) {
  return a.xmin <= b.xmax && b.xmin <= a.xmax && a.ymin <= b.ymax && b.ymin <= a.ymax;
}

/// The smallest box around places; no_box where there are none.
inline Box box_of(std::span<const Point2> places) {
  Box box = no_box;
  for (const Point2 p : places) box = around(box, p);
  return box;
}
/// Around the corners of a face.
inline Box box_of(const Tin& tin, const Face& f) {
  return around(around(around(no_box, plan(tin.vertices[f[0]])), plan(tin.vertices[f[1]])), plan(tin.vertices[f[2]]));
}

/// A box with room to spare around another one, out to which ghost faces go.
inline Box frame_around(const Box& box) {
  const double margin = 1 + (box.xmax - box.xmin) + (box.ymax - box.ymin);
  return {box.xmin - margin, box.ymin - margin, box.xmax + margin, box.ymax + margin};
}

/// bounds() on the context's threads.
Box bounds(std::span<const Point> vertices, const Context& context);

}  // namespace terrane
