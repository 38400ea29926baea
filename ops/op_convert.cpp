// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/inputs.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"

namespace terrane {
namespace {

struct ConvertParameters {
  void visit(Fields&) {}
};

Outcome run(std::vector<Surface>& inputs, const ConvertParameters&, Context&) {
  Outcome outcome;
  outcome.result = std::move(std::get<Tin>(input(inputs, "surface").value));
  return outcome;
}

}  // namespace

Operation convert() {
  return operation<ConvertParameters>(
      {.id = "convert",
       .title = "Convert to another format",
       .description = "The same TIN in another format, checked on the way: harmless defects are mended and counted.",
       .inputs = {{"surface", 1, 1, false, "The surface: a TIN, or a raster, which is triangulated."}}},
      run);
}

}  // namespace terrane
