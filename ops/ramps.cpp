// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/ramps.hpp"

#include <memory>
#include <utility>

#include "ops/heights.hpp"
#include "ops/measure.hpp"

namespace terrane {
namespace {

struct OwnField {
  explicit OwnField(Tin faces) : tin(std::move(faces)), field(tin, 64) {
    // A vertex on it may be one of sloped faces alone, at the border of the domain.
    field.take_border_for_inside();
  }
  Tin tin;
  HeightField field;  // looks at tin
};

}  // namespace

void leave_ramps_out(Tin ramps, const char* name, const Crs& crs, Outcome& outcome, Context& context) {
  if (ramps.faces.empty()) return;
  outcome.certificate[name] = {{"faces", ramps.faces.size()}, {"area_2d", domain_area(ramps, crs, context)}};
  const std::size_t inputs = outcome.fields.size();
  auto own = std::make_shared<const OwnField>(std::move(ramps));
  outcome.fields.emplace_back(own, &own->field);
  outcome.expected_height = [inputs, fold = std::move(outcome.expected_height)](
                                const std::vector<std::optional<HeightRange>>& z) -> std::optional<HeightRange> {
    if (z[inputs]) return {};
    return fold({z.begin(), z.begin() + static_cast<std::ptrdiff_t>(inputs)});
  };
}

}  // namespace terrane
