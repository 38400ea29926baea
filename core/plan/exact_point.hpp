// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include "core/plan/exact_place.hpp"

// Exact positions as numbers. Includes CGAL's heavy headers: for .cpp files of the core only.
namespace terrane {

using ExactKernel = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactPoint = ExactKernel::Point_2;

/// For a crossing: where on the way from r to s it lies, 0 to 1.
inline ExactKernel::FT exact_parameter(const ExactPlace& c) {
  using Number = ExactKernel::FT;
  const auto area2 = [&](Point2 v) {
    return (Number(c.q.x) - c.p.x) * (Number(v.y) - c.p.y) - (Number(c.q.y) - c.p.y) * (Number(v.x) - c.p.x);
  };
  const Number at_r = area2(c.r), at_s = area2(c.s);
  return at_r / (at_r - at_s);
}

/// The exact position behind `place`; an input vertex lies at `own`.
inline ExactPoint exact_point(const ExactPlace& place, Point2 own) {
  using Number = ExactKernel::FT;
  if (place.kind == ExactPlace::input) return {own.x, own.y};
  const bool ratio = place.kind == ExactPlace::ratio;
  const ExactPoint from(ratio ? place.p.x : place.r.x, ratio ? place.p.y : place.r.y);
  const ExactPoint to(ratio ? place.q.x : place.s.x, ratio ? place.q.y : place.s.y);
  return from +
         (to - from) * (ratio ? Number(place.dp) / (Number(place.dp) - Number(place.dq)) : exact_parameter(place));
}

}  // namespace terrane
