// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/volume.hpp"

#include <algorithm>

#include "core/box.hpp"
#include "core/level_order.hpp"
#include "core/overlay.hpp"
#include "core/parallel.hpp"
#include "core/sum.hpp"
#include "core/volume/area_weights.hpp"
#include "core/volume/volume_sum.hpp"

namespace terrane {
namespace {

constexpr std::size_t faces_per_report = 65536;

void report(Context& context, std::size_t done, std::size_t all) {
  if (done % faces_per_report == 0)
    context.progress("volume", static_cast<double>(done) / static_cast<double>(std::max<std::size_t>(all, 1)));
}

std::array<Point2, 3> corners(const Tin& tin, const Face& f) {
  return {plan(tin.vertices[f[0]]), plan(tin.vertices[f[1]]), plan(tin.vertices[f[2]])};
}

std::array<double, 3> heights(const Tin& tin, const Face& f) {
  return {tin.vertices[f[0]].z, tin.vertices[f[1]].z, tin.vertices[f[2]].z};
}

double area_of(const std::array<Point2, 3>& p) {
  return 0.5 * ((p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x));
}

/// The integral of value(face, corner weights) over the faces that are no walls.
template <class Value>
double sum_over_faces(const Tin& tin, const AreaScale& scale, Value value) {
  const AreaWeights weights(scale, bounds(tin));
  Sum sum;
  for (const Face& face : tin.faces) {
    if (is_wall(tin, face)) continue;
    const auto p = corners(tin, face);
    sum.add(value(face, weights(p, area_of(p))));
  }
  return sum.value();
}

}  // namespace

Volume volume(const Tin& surface, const Tin& reference, double tolerance, const AreaScale& scale, Context& context) {
  const Overlay both = overlay(surface, reference, {}, context);
  const AreaWeights weights(scale, both.points.empty() ? Box{0, 0, 0, 0} : box_of(both.points));
  VolumeSum sum(weights, tolerance);
  for (std::size_t i = 0; i < both.faces.size(); ++i) {
    report(context, i, both.faces.size());
    const auto f = static_cast<Index>(i);
    const Face& face = both.faces[i];
    const std::array<Point2, 3> p = {both.points[face[0]], both.points[face[1]], both.points[face[2]]};
    const auto [of_surface, of_reference] = both.parents[i];
    const auto z = [&](int input) {
      return std::array<double, 3>{both.height(input, f, 0), both.height(input, f, 1), both.height(input, f, 2)};
    };
    if (of_surface != none && of_reference != none)
      sum.add(p, z(0), z(1));
    else if (of_surface != none)
      sum.add_surface_only(p);
    else if (of_reference != none)
      sum.add_reference_only(p);
  }
  return sum.result();
}

Volume volume(const Tin& surface, double level, double tolerance, const AreaScale& scale, Context& context) {
  return volumes(surface, {&level, 1}, tolerance, scale, context).front();
}

std::vector<Volume> volumes(const Tin& surface, std::span<const double> levels, double tolerance,
                            const AreaScale& scale, Context& context) {
  const AreaWeights weights(scale, bounds(surface));
  const LevelOrder level(levels);
  const std::size_t n = level.size();
  std::vector<VolumeSum> sums(n, VolumeSum(weights, tolerance));
  // What lies above a level as a whole lies above all lower ones, further by the step: it is added to one of them.
  std::vector<VolumeSum::Wholes> above(n), below(n);
  for (std::size_t f = 0; f < surface.faces.size(); ++f) {
    report(context, f, surface.faces.size());
    if (is_wall(surface, surface.faces[f])) continue;
    const auto face = VolumeSum::face(corners(surface, surface.faces[f]), heights(surface, surface.faces[f]), weights);
    const auto [low, high] = std::minmax({face.z[0], face.z[1], face.z[2]});
    const auto [first, last] = level.span(low, high, tolerance);
    for (std::size_t i = first > 0 ? first - 1 : 0; i < std::min(last + 1, n); ++i)
      sums[i].add(face, {level[i], level[i], level[i]});
    if (first > 1) above[first - 1].add(face, level[first - 1]);
    if (last + 1 < n) below[last].add(face, level[last]);
  }
  for (std::size_t i = n; i-- > 1;) {
    VolumeSum::Wholes higher;
    higher.add(above[i], level[i] - level[i - 1]);
    sums[i - 1].add_above(higher, level[i - 1]);
    above[i - 1].add(higher, 0);
  }
  for (std::size_t i = 1; i < n; ++i) {
    VolumeSum::Wholes lower;
    lower.add(below[i - 1], level[i] - level[i - 1]);
    sums[i].add_below(lower, level[i]);
    below[i].add(lower, 0);
  }
  std::vector<Volume> volumes(n);
  for (std::size_t i = 0; i < n; ++i) volumes[level.in_list(i)] = sums[i].result();
  return volumes;
}

double integral(const Tin& tin, const AreaScale& scale) {
  return sum_over_faces(tin, scale, [&](const Face& face, const std::array<double, 3>& w) {
    const auto z = heights(tin, face);
    return w[0] * z[0] + w[1] * z[1] + w[2] * z[2];
  });
}

double area(const Tin& tin, const AreaScale& scale) {
  return sum_over_faces(tin, scale, [](const Face&, const auto& w) { return w[0] + w[1] + w[2]; });
}

double plan_area(const Tin& tin, const Context& context) {
  std::vector<Sum> sums(tin.faces.size() / faces_per_report + 1);
  parallel_for(context, tin.faces.size(), faces_per_report, [&](std::size_t begin, std::size_t end) {
    Sum sum;
    for (std::size_t f = begin; f < end; ++f) {
      const double third = area_of(corners(tin, tin.faces[f])) / 3;
      sum.add(third + third + third);  // as area() does
    }
    sums[begin / faces_per_report] = sum;
  });
  for (std::size_t i = 1; i < sums.size(); ++i) sums[0].add(sums[i]);
  return sums[0].value();
}

}  // namespace terrane
