// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmpxx.h>

#include <vector>

#include "core/tin.hpp"
#include "support/plan_mesh.hpp"

// What the faces of two TINs share, pair by pair: the truth about an overlay where both surfaces exist.
namespace terrane::support {

struct Cell {
  Index a = none, b = none;
  long double area = 0;  // good to about 1e-18 of the faces' extent squared
  double perimeter = 0;
  double volume = 0;  // the integral of z_a - z_b
};

/// The pairs of faces whose interiors meet, which is decided exactly, ordered by (a, b).
std::vector<Cell> shared_cells(const Tin& a, const Tin& b);

/// The area that two counter-clockwise triangles share, exactly.
mpq_class shared_area_exact(const Triangle& s, const Triangle& t);

}  // namespace terrane::support
