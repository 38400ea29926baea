// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/contour.hpp"
#include "ops/idle_parameters.hpp"
#include "ops/inputs.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"

namespace terrane {
namespace {

constexpr double most_levels = 10000;

struct ContourParameters {
  std::optional<Length> interval;
  Length base;
  std::vector<double> levels;

  void visit(Fields& f) {
    f.length("interval", interval, {.minimum = 0},
             "The step from one level to the next; either this or levels is needed.");
    f.length("base", base, {}, "A height that levels are counted from, up and down.");
    f.numbers(
        "levels", levels,
        "The heights of the contours instead: a list (90,95,100) or from:to:step (90:110:5), in the surface's unit "
        "of heights.");
  }
};

void check(const nlohmann::json& values, const std::vector<InputPart>&) {
  const auto p = filled<ContourParameters>(values);
  if (p.interval.has_value() == !p.levels.empty())
    throw Error(ErrorKind::usage, p.interval ? "surplus-parameter" : "missing-parameter",
                "'contour' takes either interval (with base) or levels" +
                    std::string(p.interval ? ", not both" : ": interval=10, or levels=90,95,100"));
  if (!p.interval) refuse_idle<ContourParameters>(values, {"base"}, "interval");
  if (p.interval && !(p.interval->value > 0))
    throw Error(ErrorKind::usage, "bad-parameter", "parameter 'interval' is 0; it takes a length above 0");
}

/// Ascending, each once.
std::vector<double> levels_of(const ContourParameters& p, const Surface& surface) {
  std::vector<double> levels = p.levels;
  if (p.interval) {
    const double unit = surface.crs.known() ? surface.crs.metres_per_height_unit() : 1.0;
    const double interval = p.interval->in(unit), base = p.base.in(unit);
    const HeightSpan span = height_span(surface.tin());
    const double first = std::ceil((span.low - base) / interval), last = std::floor((span.high - base) / interval);
    if (!(last - first < most_levels) || std::fabs(first) > 1e15 || std::fabs(last) > 1e15)
      throw Error(ErrorKind::input, "too-many-levels",
                  "the heights of '" + surface.name + "', " + nlohmann::json(span.low).dump() + " to " +
                      nlohmann::json(span.high).dump() + ", hold more than 10000 steps of " +
                      nlohmann::json(interval).dump() + "; use a larger interval");
    for (double k = first; k <= last; ++k) levels.push_back(base + k * interval);
  }
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  return levels;
}

Outcome run(std::vector<Surface>& inputs, const ContourParameters& p, Context& context) {
  const Surface& surface = input(inputs, "surface");
  const std::vector<double> levels = levels_of(p, surface);
  std::vector<Contour> lines = contours(surface.tin(), levels, context);
  if (lines.empty()) {
    const HeightSpan span = height_span(surface.tin());
    context.warn({"no-contours", surface.name, "",
                  "no level is passed: the heights of '" + surface.name + "' are " + nlohmann::json(span.low).dump() +
                      " to " + nlohmann::json(span.high).dump(),
                  "choose levels between them"});
  }
  Vectors vectors;
  std::size_t closed = 0, points = 0;
  for (Contour& contour : lines) {
    closed += contour.closed;
    points += contour.line.size();
    vectors.features.push_back({.properties = {{"level", contour.level}}, .lines = {std::move(contour.line)}});
  }
  Outcome outcome;
  outcome.certificate["contours"] = {
      {"levels", levels.size()}, {"lines", lines.size()}, {"closed", closed}, {"points", points}};
  outcome.result = std::move(vectors);
  return outcome;
}

}  // namespace

Operation contour() {
  return operation<ContourParameters>(
      {.id = "contour",
       .title = "Draw contours",
       .description = "The lines where a surface passes given heights, joined as far as they go, the higher ground on "
                      "their right; "
                      "a row for each with its level. They are the borders of the areas {z >= level} inside the "
                      "domain: flat ground "
                      "at a level has its outline, the border of the domain is none, a wall gives its line in plan.",
       .inputs = {{"surface", 1, 1, false, "The surface: a TIN or a raster."}},
       .result = ResultKind::vectors,
       .check = check,
       .example = {.parameters = {{"interval", "5"}}}},
      run);
}

}  // namespace terrane
