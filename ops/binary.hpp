// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "io/geodesy.hpp"
#include "ops/parameters.hpp"

// What the operations on surfaces of true and false have in common.
namespace terrane {

/// The levels of a result.
struct BinaryHeights {
  double z_false = 0, z_true = 255;

  void visit(Fields& fields);
  /// Throws Error{usage} unless true is the higher one, by more than rounding: read again, it would mean the opposite.
  void check() const;
  double mean() const { return z_false + (z_true - z_false) / 2; }
  double of(bool truth) const { return truth ? z_true : z_false; }
};

/// {"true_2d": .., "false_2d": ..}, in the CRS's units of area: the part `truth` of a certificate.
nlohmann::json truth_areas(const Tin& result, const BinaryHeights& heights, const Crs& crs, Context& context);

/// {"faces": .., "area_2d": ..} of the faces of a surface that lie at one of the levels, exactly.
nlohmann::json flat_areas(const Tin& surface, const std::vector<double>& levels, const Crs& crs, Context& context);

}  // namespace terrane
