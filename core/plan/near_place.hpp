// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Exact_rational.h>

#include <cmath>

#include "core/plan/exact_place.hpp"

// Exact places as numbers: nearly, in doubles, and to the last digit. Includes CGAL's numbers: for .cpp files of the
// core only.
namespace terrane {

/// at + offset, to within `error` in each coordinate.
struct NearPlace {
  Point2 at, offset;
  double error = 0;
  Index vertex = none;  // whose exact place it is; none: exactly `at`

  bool plain() const { return vertex == none; }
  double reach() const { return plain() ? 0 : std::fmax(std::fabs(offset.x), std::fabs(offset.y)) + error; }
};

/// The exact place of vertex v, whose double place is `rounded`.
NearPlace near_place(const ExactPlace& place, Point2 rounded, Index v);

using Rational = CGAL::Exact_rational;

/// Exactly.
struct ExactPair {
  Rational x, y;
  bool operator==(const ExactPair&) const = default;
};
ExactPair exact_pair(const ExactPlace& place);

}  // namespace terrane
