// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "core/overlay.hpp"
#include "support/small_mesh.hpp"

// Overlays of two small meshes, as tests of mending ask for them.
namespace terrane {

inline Overlay overlaid(const Tin& a, const Tin& b, double snap = 0) {
  Context context;
  return overlay(a, b, {.snap = snap}, context);
}

inline bool has(const Overlay& o, Point2 p) { return std::find(o.points.begin(), o.points.end(), p) != o.points.end(); }

inline Tin triangle_of(Point p, Point q, Point r) { return canonical(Tin{{p, q, r}, {{0, 1, 2}}}); }

}  // namespace terrane
