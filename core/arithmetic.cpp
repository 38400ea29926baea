// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/arithmetic.hpp"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "core/error.hpp"
#include "core/merge/ramp.hpp"
#include "core/parallel.hpp"
#include "core/predicates.hpp"

namespace terrane {
namespace {

/// An order of surfaces by content alone, so that a + b and b + a, a - b and b - a take the same path.
bool content_before(const Tin& a, const Tin& b) {
  if (a.vertices.size() != b.vertices.size()) return a.vertices.size() < b.vertices.size();
  if (a.faces.size() != b.faces.size()) return a.faces.size() < b.faces.size();
  const auto before = [](const Point& p, const Point& q) { return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z); };
  const auto differs = std::mismatch(a.vertices.begin(), a.vertices.end(), b.vertices.begin());
  if (differs.first != a.vertices.end()) return before(*differs.first, *differs.second);
  return a.faces < b.faces;
}

/// The folded surface without the faces that have no height.
class Folder {
 public:
  /// `signs` of the two heights; with Outside::keep both are +1.
  Folder(Overlay overlay, std::array<int, 2> signs, Outside outside)
      : overlay_(std::move(overlay)), signs_(signs), outside_(outside) {}

  /// Where both inputs are continuous and only their overlap is kept, each place has one height: no corner is asked.
  bool one_height_per_place() const {
    return outside_ == Outside::drop && !overlay_.per_corner[0] && !overlay_.per_corner[1];
  }

  Tin by_place(const Context& context) {
    Array<double>& z = overlay_.heights[0];
    parallel_for(context, z.size(), chunk_for(context, z.size()), [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) z[v] = signs_[0] * z[v] + signs_[1] * overlay_.heights[1][v];
    });
    parallel_for(context, overlay_.faces.size(), chunk_for(context, overlay_.faces.size()),
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t f = begin; f < end; ++f)
                     if (!both(f)) overlay_.faces[f][0] = none;
                 });
    Array<double>().swap(overlay_.heights[1]);  // the result can have their memory
    Array<std::array<Index, 2>>().swap(overlay_.parents);
    return canonical(overlay_.points, z, overlay_.faces, context);
  }

  CornerSurface by_corner() {
    CornerSurface surface;
    surface.points = overlay_.points;
    surface.faces.reserve(overlay_.faces.size());
    surface.z.reserve(3 * overlay_.faces.size());
    for (std::size_t f = 0; f < overlay_.faces.size(); ++f) {
      if (!both(f) && outside_ == Outside::drop) continue;
      surface.faces.push_back(overlay_.faces[f]);
      for (int k = 0; k < 3; ++k) surface.z.push_back(height(static_cast<Index>(f), k));
    }
    return surface;
  }

  /// All faces, those outside sloped to the overlap.
  Ramped ramped(const Tin& a, const Tin& b, Context& context) {
    RampGround ground;
    for (std::size_t f = 0; f < overlay_.faces.size(); ++f) {
      const auto& [in_a, in_b] = overlay_.parents[f];
      ground.rank.push_back(both(f));
      ground.origin.push_back(in_a != none ? std::array<Index, 2>{0, in_a} : std::array<Index, 2>{1, in_b});
    }
    ground.area = [&](Index input, Index face) {
      const Tin& tin = input == 0 ? a : b;
      return area2_accurate(tin, tin.faces[face]);
    };
    return ramp(by_corner(), ground, Meeting::mean, context);
  }

 private:
  bool both(std::size_t f) const { return overlay_.parents[f][0] != none && overlay_.parents[f][1] != none; }

  double height(Index f, int k) const {
    double sum = 0;
    for (int input : {0, 1})
      if (overlay_.parents[f][input] != none) sum += signs_[input] * overlay_.height(input, f, k);
    return sum;
  }

  Overlay overlay_;
  std::array<int, 2> signs_;
  Outside outside_;
};

}  // namespace

Assembled combine(const Tin& a, const Tin& b, int sign, Outside outside, const Assembly& assembly, Context& context) {
  if (sign < 0 && outside == Outside::keep)
    throw Error(ErrorKind::usage, "outside",
                "a difference has no height of its own outside the overlap; use drop or zero");
  const bool swap = content_before(b, a);
  const Tin &first = swap ? b : a, &second = swap ? a : b;
  Overlay overlaid = overlay(first, second, {}, context);
  const RoundingReport rounding = overlaid.rounding;
  const std::array<int, 2> signs = swap ? std::array{sign, 1} : std::array{1, sign};
  Folder folder(std::move(overlaid), signs, outside);
  Assembled result;
  if (folder.one_height_per_place()) {
    result.tin = folder.by_place(context);
    context.progress("assemble", 1);
  } else if (assembly.seam == Seam::ramp && outside != Outside::drop) {
    Ramped ramped = folder.ramped(first, second, context);
    Tin ramps = faces_in_plan(ramped.surface.points, ramped.surface.faces, ramped.sloped);
    result = assemble(std::move(ramped.surface), assembly, context);
    result.ramps = std::move(ramps);
  } else {
    result = assemble(folder.by_corner(), assembly, context);
  }
  accumulate(result.rounding, rounding);
  return result;
}

Tin offset(Tin a, double level) {
  for (Point& p : a.vertices) p.z += level;
  return a;
}

}  // namespace terrane
