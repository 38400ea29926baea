// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/arithmetic.hpp"
#include "core/predicates.hpp"
#include "core/volume.hpp"
#include "ops/heights.hpp"
#include "ops/inputs.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"
#include "ops/ramps.hpp"
#include "ops/union_area.hpp"

namespace terrane {
namespace {

struct SubtractParameters {
  Outside outside = Outside::drop;
  Seam seam = Seam::wall;
  bool allow_empty = false;

  void visit(Fields& f) {
    f.choice(
        "outside", outside, {{"drop", Outside::drop}, {"zero", Outside::zero}},
        "What is returned where only one surface exists: nothing, or the difference with the missing one at height 0.");
    f.choice("seam", seam, {{"wall", Seam::wall}, {"ramp", Seam::ramp}, {"split", Seam::split}},
             "What happens where heights jump at the border of the overlap: closed by vertical faces, sloped down "
             "within the faces that the border cuts or touches, or left open.");
    f.boolean("allow-empty", allow_empty, "Return an empty surface, with a warning, where the two do not overlap.");
  }
};

HeightFold difference_of_heights(Outside outside) {
  return [outside](const std::vector<std::optional<HeightRange>>& z) -> std::optional<HeightRange> {
    if (z[0] && z[1]) return HeightRange{z[0]->low - z[1]->high, z[0]->high - z[1]->low};
    if (outside == Outside::drop) return {};
    if (z[0]) return z[0];
    if (z[1]) return HeightRange{-z[1]->high, -z[1]->low};
    return {};
  };
}

/// Whether the area of a surface in plan exceeds a bound: most often a few faces are enough to tell.
bool larger_than(const Tin& tin, double bound) {
  double sum = 0;
  for (const Face& f : tin.faces) {
    sum += 0.5 * std::max(0.0, area2_accurate(tin, f));
    if (sum > bound) return true;
  }
  return false;
}

Outcome run(std::vector<Surface>& inputs, const SubtractParameters& p, Context& context) {
  Surface &minuend = input(inputs, "minuend"), &subtrahend = input(inputs, "subtrahend");
  Outcome outcome;
  if (subtrahend.level()) {
    const double level = std::get<double>(subtrahend.value);
    outcome.result = with_heights(std::move(std::get<Tin>(minuend.value)), 1, -level, minuend.name,
                                  nlohmann::json(level).dump() + " subtracted (input '" + subtrahend.slot + "')");
    return outcome;
  }
  warn_feet_beside_metres(minuend, subtrahend, context);
  const double area_a = plan_area(minuend.tin(), context), area_b = plan_area(subtrahend.tin(), context);
  // The overlap by the borders alone is what the difference's area is held against.
  outcome.fields = height_fields({&minuend.tin(), &subtrahend.tin()}, context);
  const auto united = union_area(outcome.fields, context);
  Assembled difference = combine(minuend.tin(), subtrahend.tin(), -1, p.outside, {p.seam, 0}, context);
  // Whether they overlap is for the overlay to say, where it returns nothing but the overlap.
  const double least = 1e-12 * std::min(area_a, area_b);
  const bool overlapping = p.outside == Outside::drop ? larger_than(difference.tin, least)
                           : united                   ? area_a + area_b - *united > least
                                                      : std::min(area_a, area_b) > least;
  if (difference.tin.faces.empty() || !overlapping) {
    if (!p.allow_empty) refuse_no_overlap(minuend, subtrahend);
    if (p.outside == Outside::drop) warn_no_overlap(minuend, subtrahend, context);
  }
  if (united) outcome.expected_area = p.outside == Outside::zero ? *united : area_a + area_b - *united;
  outcome.expected_height = difference_of_heights(p.outside);
  leave_ramps_out(std::move(difference.ramps), "ramps", minuend.crs, outcome, context);
  outcome.rounding = difference.rounding;
  outcome.result = std::move(difference.tin);
  return outcome;
}

}  // namespace

Operation subtract() {
  return operation<SubtractParameters>(
      {.id = "subtract",
       .title = "Subtract one surface from another",
       .description = "The surface whose height is the minuend's minus the subtrahend's wherever both exist: exact "
                      "everywhere, not only at vertices.",
       .inputs = {{"minuend", 1, 1, false, "The surface to subtract from: a TIN or a raster."},
                  {"subtrahend", 1, 1, true, "The surface that is subtracted: a TIN, a raster, or a number."}}},
      run);
}

}  // namespace terrane
