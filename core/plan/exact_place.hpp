// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/tin.hpp"

namespace terrane {

/// Where a vertex that rounding moves lies exactly, by the input coordinates that say so.
struct ExactPlace {
  enum Kind { input, crossing, ratio, lattice } kind = input;
  Point2 p, q;            // crossing: the line p q; ratio: from p to q; lattice: p, an input vertex that may move
  Point2 r = {}, s = {};  // crossing: the line r s
  double dp = 0, dq = 0;  // ratio: values of opposite sign at p and q; the place is where they interpolate to 0
};

/// The double place of an exact one, to about an ulp of its coordinates; coordinates that the lines hold constant are
/// kept.
Point2 rounded(const ExactPlace& place);

/// An upper bound of |rounded(place) - place|.
double rounding_bound(const ExactPlace& place);

}  // namespace terrane
