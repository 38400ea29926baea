// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/arithmetic.hpp"
#include "core/merge.hpp"
#include "core/volume.hpp"
#include "ops/heights.hpp"
#include "ops/inputs.hpp"
#include "ops/measure.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"
#include "ops/ramps.hpp"
#include "ops/seams.hpp"
#include "ops/union_area.hpp"

namespace terrane {
namespace {

struct AddParameters {
  Outside outside = Outside::keep;
  Seam seam = Seam::wall;

  void visit(Fields& f) {
    f.choice(
        "outside", outside, {{"keep", Outside::keep}, {"drop", Outside::drop}, {"zero", Outside::zero}},
        "What is returned where only one surface exists: keep it at its own height, drop it, or take the missing one "
        "as height 0.");
    f.choice("seam", seam, {{"wall", Seam::wall}, {"ramp", Seam::ramp}, {"split", Seam::split}},
             "What happens where heights jump at the border of the overlap: closed by vertical faces, sloped down "
             "within the faces that the border cuts or touches, or left open.");
  }
};

HeightFold sum_of_heights(Outside outside) {
  return [outside](const std::vector<std::optional<HeightRange>>& z) -> std::optional<HeightRange> {
    if (z[0] && z[1]) return HeightRange{z[0]->low + z[1]->low, z[0]->high + z[1]->high};
    if (outside == Outside::drop) return {};
    return z[0] ? z[0] : z[1];
  };
}

Outcome run(std::vector<Surface>& inputs, const AddParameters& p, Context& context) {
  Surface &a = input(inputs, "a"), &b = input(inputs, "b");
  Outcome outcome;
  if (b.level()) {
    const double level = std::get<double>(b.value);
    outcome.result = with_heights(std::move(std::get<Tin>(a.value)), 1, level, a.name,
                                  nlohmann::json(level).dump() + " added (input '" + b.slot + "')");
    return outcome;
  }
  warn_feet_beside_metres(a, b, context);
  Assembled sum = combine(a.tin(), b.tin(), +1, p.outside, {p.seam, 0}, context);
  if (sum.tin.faces.empty()) refuse_no_overlap(a, b, "outside=keep");

  const double apart = plan_area(a.tin(), context) + plan_area(b.tin(), context);
  outcome.fields = height_fields({&a.tin(), &b.tin()}, context);
  if (const auto united = union_area(outcome.fields, context))
    outcome.expected_area = p.outside == Outside::drop ? apart - *united : *united;
  // What the two say of each other, as a merge would report it.
  MergeOptions options{Overlap::first, {Seam::split, 0}};
  options.metric = plan_metric(a.crs);
  Merged measured = merge({a.tin(), b.tin()}, options, context);
  for (SeamPair& pair : measured.seams) {
    measure_jumps(sum.tin, options.metric, pair);
    pair.wall_area = p.seam == Seam::wall ? pair.jump_mean_abs * pair.jump_length_2d : 0;
  }
  outcome.certificate["seams"] = seam_report(measured.seams, {a.name, b.name});
  outcome.expected_height = sum_of_heights(p.outside);
  leave_ramps_out(std::move(sum.ramps), "ramps", a.crs, outcome, context);
  outcome.rounding = sum.rounding;
  outcome.result = std::move(sum.tin);
  return outcome;
}

}  // namespace

Operation add() {
  return operation<AddParameters>(
      {.id = "add",
       .title = "Add two surfaces",
       .description = "The surface whose height is the sum of the two surfaces' heights wherever both exist: exact "
                      "everywhere, not only at vertices.",
       .inputs = {{"a", 1, 1, false, "The first surface: a TIN or a raster."},
                  {"b", 1, 1, true, "The second surface: a TIN, a raster, or a number added to every height."}}},
      run);
}

}  // namespace terrane
