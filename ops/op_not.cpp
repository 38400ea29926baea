// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/volume.hpp"
#include "ops/binary.hpp"
#include "ops/inputs.hpp"
#include "ops/operations.hpp"

namespace terrane {
namespace {

struct NotParameters {
  BinaryHeights heights;
  void visit(Fields& f) { heights.visit(f); }

  /// The two levels become each other exactly, whatever their sum rounds to.
  double of(double z) const {
    if (z == heights.z_false) return heights.z_true;
    if (z == heights.z_true) return heights.z_false;
    return heights.z_false + heights.z_true - z;
  }
};

Outcome run(std::vector<Surface>& inputs, const NotParameters& p, Context& context) {
  const Surface& surface = input(inputs, "a");
  const double sum = p.heights.z_false + p.heights.z_true;
  Tin tin = with_heights(surface.tin(), -1, sum, surface.name, nlohmann::json(sum).dump() + " minus it");
  for (std::size_t v = 0; v < tin.vertices.size(); ++v) tin.vertices[v].z = p.of(surface.tin().vertices[v].z);

  Outcome outcome;
  outcome.expected_height = [p](const std::vector<std::optional<HeightRange>>& z) -> std::optional<HeightRange> {
    if (!z[0]) return {};
    return HeightRange{p.of(z[0]->high), p.of(z[0]->low)};
  };
  outcome.expected_area = plan_area(surface.tin(), context);
  outcome.result = canonical(std::move(tin), context);
  return outcome;
}

}  // namespace

Operation logic_not() {
  return operation<NotParameters>(
      {.id = "not",
       .title = "Exchange true and false",
       .description =
           "Every height z becomes z-false + z-true - z. Any surface will do: of one that is not binary it is the "
           "negative. Binary surfaces at other levels are brought to z-false and z-true by 'threshold' first.",
       .inputs = {{"a", 1, 1, false, "The surface: a TIN or a raster."}},
       .example = {.files = {"a.obj"}}},
      run);
}

}  // namespace terrane
