// SPDX-License-Identifier: GPL-3.0-or-later
#include <terrane/core/arithmetic.hpp>
#include <terrane/core/validate.hpp>
#include <terrane/core/volume.hpp>
#include <terrane/io/format.hpp>

#include <cstdio>

// Reads two squares from OBJ, subtracts them, and measures what lies between.
int main() {
  using namespace terrane;
  Context context;
  const Format* obj = format_named("obj");
  const auto read = [&](const char* text) {
    return checked(std::get<Tin>(obj->read(text, {.name = "square.obj"}, context).surface), "square.obj", context);
  };
  const Tin a = read("v 0 0 5\nv 4 0 5\nv 4 4 5\nv 0 4 5\nf 1 2 3\nf 1 3 4\n");
  const Tin b = read("v 2 0 2\nv 6 0 2\nv 6 4 2\nv 2 4 2\nf 1 2 3\nf 1 3 4\n");
  const Assembled difference = combine(a, b, -1, Outside::drop, {}, context);
  const Inspection inspection = inspect(difference.tin);
  const HeightSpan heights = height_span(difference.tin);
  const Volume between = volume(a, b, 0, {}, context);
  const double area = plan_area(difference.tin);
  std::printf("area %g, height %g to %g, fill %g, cut %g\n", area, heights.low, heights.high, between.fill.volume,
              between.cut.volume);
  const bool right = area == 8 && heights.low == 3 && heights.high == 3 && between.fill.volume == 24 &&
                     between.cut.volume == 0 && inspection.overlaps + inspection.t_junctions + inspection.inverted == 0;
  return right ? 0 : 1;
}
