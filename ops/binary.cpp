// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/binary.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/level_cuts.hpp"
#include "ops/measure.hpp"

namespace terrane {

void BinaryHeights::visit(Fields& f) {
  f.number("z-false", z_false, {}, "height units", "The height of what is false in the result.");
  f.number("z-true", z_true, {}, "height units", "The height of what is true in the result.");
}

void BinaryHeights::check() const {
  if (z_true - z_false > 1e-8 * std::max({1.0, std::fabs(z_false), std::fabs(z_true)}) &&
      std::max(std::fabs(z_false), std::fabs(z_true)) <= 1e100)
    return;
  throw Error(
      ErrorKind::usage, "bad-parameter",
      "z-true is " + nlohmann::json(z_true).dump() + " and z-false " + nlohmann::json(z_false).dump() +
          "; the upper level of a binary surface is its true one, so z-true must be above z-false (true-when of "
          "'threshold', or 'not', exchanges the two)");
}

nlohmann::json truth_areas(const Tin& result, const BinaryHeights& heights, const Crs& crs, Context& context) {
  nlohmann::json areas;
  for (const bool truth : {true, false}) {
    Tin part{result.vertices, {}};
    for (const Face& f : result.faces)
      if (result.vertices[f[0]].z == heights.of(truth) && !is_wall(result, f)) part.faces.push_back(f);
    areas[truth ? "true_2d" : "false_2d"] = domain_area(part, crs, context);
  }
  return areas;
}

nlohmann::json flat_areas(const Tin& surface, const std::vector<double>& levels, const Crs& crs, Context& context) {
  const Tin flat = flat_faces(surface, levels);
  return {{"faces", flat.faces.size()}, {"area_2d", flat.faces.empty() ? 0.0 : domain_area(flat, crs, context)}};
}

}  // namespace terrane
