// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "core/simplify.hpp"
#include "core/volume.hpp"
#include "ops/inputs.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"

namespace terrane {
namespace {

struct SimplifyParameters {
  std::optional<Length> max_error;
  std::optional<long> max_triangles;
  bool keep_boundary = true, coplanar_only = false;

  void visit(Fields& f) {
    f.length(
        "max-error", max_error, {.minimum = 0},
        "How far the result may be from the surface, vertically, at any place: at vertices and where edges cross.");
    f.integer(
        "max-triangles", max_triangles, {.minimum = 1, .maximum = 1e9},
        "Stop at that many faces, walls counted; the error reached is reported. A max-error given besides goes first.");
    f.boolean(
        "keep-boundary", keep_boundary,
        "Keep the border vertex for vertex, so that neighbours simplified apart still meet. Otherwise vertices go "
        "where it runs exactly straight on in plan; the domain is the same in any case.");
    f.boolean("coplanar-only", coplanar_only,
              "Take out nothing but what lies in the plane of its faces to the rounding of heights, "
              "1e-9 · max(1, |z|): undoes the growth that overlays cause.");
  }
};

void check(const nlohmann::json& values, const std::vector<InputPart>&) {
  const auto p = filled<SimplifyParameters>(values);
  if (p.coplanar_only && (p.max_error || p.max_triangles))
    throw Error(ErrorKind::usage, "surplus-parameter",
                "'simplify' takes coplanar-only=true without max-error and max-triangles: its bound is the rounding of "
                "heights");
  if (!p.coplanar_only && !p.max_error && !p.max_triangles)
    throw Error(ErrorKind::usage, "missing-parameter",
                "'simplify' needs max-error, max-triangles or coplanar-only=true");
}

HeightFold height_of_the_surface() {
  return [](const std::vector<std::optional<HeightRange>>& z) { return z[0]; };
}

void warn_not_reached(const Tin& tin, const SimplifyParameters& p, Context& context) {
  if (!p.max_triangles || tin.faces.size() <= static_cast<std::size_t>(*p.max_triangles)) return;
  context.warn({"max-triangles-not-reached", "", "",
                std::to_string(tin.faces.size()) +
                    " faces are left, more than max-triangles=" + std::to_string(*p.max_triangles) +
                    (p.max_error ? ": max-error lets no more go" : ": the border, walls and jumps hold them"),
                p.max_error       ? "raise max-error"
                : p.keep_boundary ? "set keep-boundary=false"
                                  : ""});
}

Outcome run(std::vector<Surface>& inputs, const SimplifyParameters& p, Context& context) {
  const Surface& surface = input(inputs, "surface");
  const Tin& tin = surface.tin();
  SimplifyOptions options;
  options.keep_boundary = p.keep_boundary;
  if (p.coplanar_only) options.max_error = coplanar_tolerance(tin);
  if (p.max_error)
    options.max_error = p.max_error->in(surface.crs.known() ? surface.crs.metres_per_height_unit() : 1.0);
  if (p.max_triangles) options.max_triangles = *p.max_triangles;
  Simplified made = simplify_and_verify(tin, options, context);
  warn_not_reached(made.tin, p, context);

  Outcome outcome;
  outcome.expected_height = height_of_the_surface();
  outcome.expected_area = plan_area(tin, context);
  outcome.approximation = {
      {"max_error", std::isfinite(options.max_error) ? nlohmann::json(options.max_error) : nlohmann::json()},
      {"measured", made.error},
      {"on_overlay", made.verified},
      {"against", "the surface as it came, at every vertex and wherever edges cross"}};
  outcome.result = std::move(made.tin);
  return outcome;
}

}  // namespace

Operation simplify_operation() {
  return operation<SimplifyParameters>({.id = "simplify",
                                        .title = "Simplify a surface within a bound",
                                        .description = "Fewer faces on some of the surface's vertices, nowhere further "
                                                       "from it (vertically) than max-error; border, "
                                                       "walls and jumps stay. A raster is taken with all its samples.",
                                        .inputs = {{"surface", 1, 1, false, "The surface: a TIN or a raster."}},
                                        .intake = {.every_sample = true},
                                        .check = check,
       .example = {.parameters = {{"max-error", "0.5"}}}},
                                       run);
}

}  // namespace terrane
