// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/box.hpp"
#include "core/corner_heights.hpp"
#include "core/logic.hpp"
#include "core/volume.hpp"
#include "ops/binary.hpp"
#include "ops/heights.hpp"
#include "ops/inputs.hpp"
#include "ops/measure.hpp"
#include "ops/operations.hpp"
#include "ops/union_area.hpp"

// and, or, xor, nand, nor: one operation with five tables.
namespace terrane {
namespace {

struct LogicParameters {
  BinaryHeights heights;
  Extent extent = Extent::overlap;

  void visit(Fields& f) {
    heights.visit(f);
    f.choice("extent", extent, {{"overlap", Extent::overlap}, {"box", Extent::box}},
             "Where an input has no surface its truth is unknown and the place is left out (overlap); or it is false "
             "there, out to the box around both inputs (box).");
  }
};

void check(const nlohmann::json& values, const std::vector<InputPart>&) {
  filled<LogicParameters>(values).heights.check();
}

Binary read(const Surface& surface, const LogicParameters& p, Context& context) {
  BinaryRule rule{p.heights.mean(), {}, surface.name};
  const Crs& crs = surface.crs;
  if (crs.known() && (crs.geographic() || crs.metres_per_length_unit() != crs.metres_per_height_unit()))
    rule.slope = [&crs](const Point& a, const Point& b, const Point& c) {
      const double stretch = steepness(a, b, c, crs);
      return std::sqrt(std::max(0.0, stretch * stretch - 1));
    };
  return read_binary(surface.tin(), rule, context);
}

/// Which answers a reading of an input allows: on a wall, and on what is as steep, either.
struct Answers {
  bool may[2];
};

Answers answers(const Binary& binary, const HeightRange& z, double mean) {
  if (binary.one_level) return {{binary.lower < mean, binary.lower >= mean}};
  return {{z.low<binary.upper - rounding_jump(binary.upper), z.high> binary.lower + rounding_jump(binary.lower)}};
}

HeightFold truth_height(const Binary& a, const Binary& b, const LogicParameters& p, const TruthTable& table) {
  // The meshes are of no use here.
  const auto levels = [](const Binary& binary) {
    Binary kept;
    kept.lower = binary.lower, kept.upper = binary.upper, kept.one_level = binary.one_level;
    return kept;
  };
  return [of = std::array{levels(a), levels(b)}, p,
          table](const std::vector<std::optional<HeightRange>>& z) -> std::optional<HeightRange> {
    if (p.extent == Extent::overlap && !(z[0] && z[1])) return {};
    const auto in = [&](int i) { return z[i] ? answers(of[i], *z[i], p.heights.mean()) : Answers{{true, false}}; };
    const Answers x = in(0), y = in(1);
    HeightRange range{INFINITY, -INFINITY};
    for (int i = 0; i < 4; ++i) {
      if (!x.may[i / 2] || !y.may[i % 2]) continue;
      const double height = p.heights.of(table[i] == is_true);
      range = {std::min(range.low, height), std::max(range.high, height)};
    }
    return range;
  };
}

std::optional<double> expected_area(const Surface& a, const Surface& b, Extent extent, const HeightFields& fields,
                                    Context& context) {
  if (extent == Extent::box) {
    const Box box = around(bounds(a.tin()), bounds(b.tin()));
    return (box.xmax - box.xmin) * (box.ymax - box.ymin);
  }
  const auto united = union_area(fields, context);
  if (!united) return {};
  return plan_area(a.tin(), context) + plan_area(b.tin(), context) - *united;
}

Outcome combined(std::vector<Surface>& inputs, const LogicParameters& p, const TruthTable& table, Context& context) {
  const Surface &a = input(inputs, "a"), &b = input(inputs, "b");
  const Binary binary_a = read(a, p, context), binary_b = read(b, p, context);
  Combined both = combine(binary_a.mesh, binary_b.mesh, table, p.extent, context);
  if (both.mesh.faces.empty()) refuse_no_overlap(a, b, "extent=box");
  Assembled result = lifted(both.mesh, std::vector<double>{p.heights.z_false, p.heights.z_true}, context);

  Outcome outcome;
  outcome.fields = height_fields({&a.tin(), &b.tin()}, context);
  outcome.expected_area = expected_area(a, b, p.extent, outcome.fields, context);
  outcome.expected_height = truth_height(binary_a, binary_b, p, table);
  outcome.certificate["truth"] = truth_areas(result.tin, p.heights, a.crs, context);
  RoundingReport rounding = both.rounding;
  for (const RoundingReport& more : {binary_a.rounding, binary_b.rounding, result.rounding}) accumulate(rounding, more);
  outcome.rounding = rounding;
  outcome.result = std::move(result.tin);
  return outcome;
}

template <Truth both_false, Truth one_true, Truth both_true>
Operation logic(const char* id, const char* title, const char* what) {
  return operation<LogicParameters>(
      {.id = id,
       .title = title,
       .description = std::string("A binary surface that is true where ") + what +
                      ". The upper of an input's two levels is true, the lower false; one level alone is true from the "
                      "mean of z-false and z-true up. Faces steeper than 89.9 degrees count as walls. The areas of "
                      "both are combined exactly, triangulated anew and joined by walls; areas without width vanish. A "
                      "surface with other heights is refused: 'threshold' makes it binary.",
       .inputs = {{"a", 1, 1, false, "The first binary surface: level areas at two heights, joined by walls."},
                  {"b", 1, 1, false, "The second one."}},
       .check = check,
       .example = {.files = {"a.obj", "b.obj"}}},
      +[](std::vector<Surface>& inputs, const LogicParameters& p, Context& context) {
        return combined(inputs, p, {both_false, one_true, one_true, both_true}, context);
      });
}

}  // namespace

Operation logic_and() {
  return logic<is_false, is_false, is_true>("and", "True where both are true", "both inputs are");
}
Operation logic_or() {
  return logic<is_false, is_true, is_true>("or", "True where either is true", "at least one input is");
}
Operation logic_xor() {
  return logic<is_false, is_true, is_false>("xor", "True where one of the two is true", "exactly one input is");
}
Operation logic_nand() {
  return logic<is_true, is_true, is_false>("nand", "True where not both are true", "at most one input is");
}
Operation logic_nor() { return logic<is_true, is_false, is_false>("nor", "True where neither is true", "no input is"); }

}  // namespace terrane
