// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

namespace terrane {

/// A linear function on a triangle.
struct LinearPiece {
  double area;
  std::array<double, 3> values;  // at the corners
};

/// The share of the triangle where its function is at most `level`, times its area: closed form.
double area_at_most(const LinearPiece& piece, double level);

/// The value that the function stays at or below on `share` of the area (0 to 1), to 1e-13 of the range; exact where a
/// level area holds it. O(n) expected: pieces wholly on one side of the answer are dropped as the bracket closes. Needs
/// a piece.
double area_quantile(const std::vector<LinearPiece>& pieces, double share);

/// The same for |value - centre|.
double area_quantile_abs(const std::vector<LinearPiece>& pieces, double centre, double share);

}  // namespace terrane
