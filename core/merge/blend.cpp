// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge/blend.hpp"

#include <algorithm>
#include <cmath>

#include "core/merge/bisected_mesh.hpp"
#include "core/merge/line_distance.hpp"
#include "core/rounding/rounding.hpp"

namespace terrane {
namespace {

constexpr Index most_made = 8'000'000;

bool has(const Overlay& overlay, Index face, int input) { return overlay.parents[face][input] != none; }
bool has_both(const Overlay& overlay, Index face) { return has(overlay, face, 0) && has(overlay, face, 1); }

/// The border of one input inside the other, the overlap on the left.
std::vector<LineDistance::Segment> border_inside(const Overlay& overlay, const Array<Face>& neighbours, int input) {
  std::vector<LineDistance::Segment> lines;
  for (Index f = 0; f < static_cast<Index>(overlay.faces.size()); ++f)
    for (int k = 0; k < 3; ++k) {
      const Index g = neighbours[f][k];
      if (g == none || !has_both(overlay, f) || has(overlay, g, input)) continue;
      lines.push_back({overlay.points[overlay.faces[f][(k + 1) % 3]], overlay.points[overlay.faces[f][(k + 2) % 3]]});
    }
  return lines;
}

std::array<std::vector<double>, 2> corner_heights(const Overlay& overlay) {
  std::array<std::vector<double>, 2> z;
  for (const int input : {0, 1})
    for (std::size_t c = 0; c < 3 * overlay.faces.size(); ++c) {
      const auto f = static_cast<Index>(c / 3);
      z[input].push_back(has(overlay, f, input) ? overlay.height(input, f, static_cast<int>(c % 3)) : 0);
    }
  return z;
}

class Blender {
 public:
  Blender(Overlay overlay, const BlendOptions& options)
      : before_(std::move(overlay)),
        options_(options),
        mesh_(before_.points, before_.faces, corner_heights(before_), options.metric) {
    PlanarMesh connected{before_.points, before_.faces, {}, {}};
    connect(connected);
    for (const int input : {0, 1}) {
      const auto lines = border_inside(before_, connected.neighbours, input);
      lines_.emplace_back(lines, options.metric, true);
    }
    mark_borders(connected.neighbours);
    std::vector<LineDistance::Segment> corners;
    for (Index v = 0; v < static_cast<Index>(before_.points.size()); ++v)
      if (is_corner(v)) corners.push_back({before_.points[v], before_.points[v]});
    lines_.emplace_back(corners, options.metric, false);
    radius_ = std::min(options.width, extent()) / 1024;
  }

  Blended run(Context& context) {
    Blended result;
    if (!lines_[0].empty()) {
      measure(0);
      result.report.bound =
          mesh_.refine({[this](Index f) { return error(f); }, options_.tolerance, [this](Index f) { return both(f); },
                        [this](Index m, Index p, Index q, Index f, Index g) { note_made(m, p, q, f, g); }, most_made},
                       context);
    }
    result.report.made = mesh_.made();
    weigh(result);
    hand_over(result.overlay);
    return result;
  }

 private:
  bool both(Index f) const { return has_both(before_, mesh_.label(f)); }

  /// Vertices on a border are at distance 0 from it, whatever rounding says.
  void mark_borders(const Array<Face>& neighbours) {
    for (const int input : {0, 1}) on_[input].assign(before_.points.size(), 0);
    for (Index f = 0; f < static_cast<Index>(before_.faces.size()); ++f)
      for (int k = 0; has_both(before_, f) && k < 3; ++k)
        if (const Index g = neighbours[f][k]; g != none && !has_both(before_, g)) {
          std::vector<std::uint8_t>& on = on_[has(before_, g, 0) ? 1 : 0];
          on[before_.faces[f][(k + 1) % 3]] = on[before_.faces[f][(k + 2) % 3]] = 1;
        }
  }

  void note_made(Index, Index, Index, Index f, Index g) {
    for (const int input : {0, 1}) {
      const bool on_border = g != none && both(f) != both(g) && !has(before_, mesh_.label(both(f) ? g : f), input);
      on_[input].push_back(on_border);
    }
    measure(mesh_.points().size() - 1);
  }

  /// The distances of vertices from `first` on, as far as the width.
  void measure(std::size_t first) {
    for (const int input : {0, 1}) {
      distance_[input].resize(mesh_.points().size(), options_.width);
      for (std::size_t v = first; v < mesh_.points().size(); ++v)
        distance_[input][v] = on_[input][v]           ? 0
                              : lines_[input].empty() ? options_.width
                                                      : lines_[input].at(mesh_.points()[v], options_.width);
    }
    from_corner_.resize(mesh_.points().size(), radius_);
    for (std::size_t v = first; !lines_[2].empty() && v < mesh_.points().size(); ++v)
      from_corner_[v] = lines_[2].at(mesh_.points()[v], radius_);
  }

  double extent() const {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (Index f = 0; f < static_cast<Index>(before_.faces.size()); ++f)
      for (int k = 0; has_both(before_, f) && k < 3; ++k) {
        const Point2 p = before_.points[before_.faces[f][k]];
        low[0] = std::min(low[0], p.x * options_.metric.x), high[0] = std::max(high[0], p.x * options_.metric.x);
        low[1] = std::min(low[1], p.y * options_.metric.y), high[1] = std::max(high[1], p.y * options_.metric.y);
      }
    return std::max(high[0] - low[0], high[1] - low[1]);
  }

  bool is_corner(Index v) const { return on_[0][v] && on_[1][v]; }
  bool at_corner(Index f) const {
    const Face& face = mesh_.faces()[f];
    return is_corner(face[0]) || is_corner(face[1]) || is_corner(face[2]);
  }

  bool around_corner(Index f) const {
    const Face& face = mesh_.faces()[f];
    return from_corner_[face[0]] < radius_ && from_corner_[face[1]] < radius_ && from_corner_[face[2]] < radius_;
  }

  std::array<double, 3> difference(Index f) const {
    std::array<double, 3> d;
    for (int k = 0; k < 3; ++k) d[k] = mesh_.value(0, f, k) - mesh_.value(1, f, k);
    return d;
  }

  OverTriangle distance(int input, Index f) const {
    if (lines_[input].empty()) return constant(options_.width);
    const Face& face = mesh_.faces()[f];
    std::array<Point2, 3> at;
    std::array<double, 3> known;
    for (int k = 0; k < 3; ++k) at[k] = mesh_.points()[face[k]], known[k] = distance_[input][face[k]];
    return lines_[input].over(at, known, options_.width);
  }

  double error(Index f) const {
    const std::array<double, 3> d = difference(f);
    const double trivial = 2 * std::max({std::fabs(d[0]), std::fabs(d[1]), std::fabs(d[2])});
    if (trivial == 0) return 0;
    if (trivial <= options_.tolerance) return trivial;
    if (around_corner(f)) return 0;
    if (at_corner(f)) return INFINITY;
    const OverTriangle from_a = distance(0, f);
    if (from_a.error() == 0 && from_a.at == constant(options_.width).at) return 0;
    return std::min(trivial, error_of_product(smaller(constant(1), uncapped_weight(from_a, distance(1, f))), d));
  }

  /// The larger of a / width and a / (a + b): the first where a + b is at least the width, the second where it is less.
  OverTriangle uncapped_weight(const OverTriangle& a, const OverTriangle& b) const {
    const OverTriangle wide = scaled(a, 1 / options_.width), narrow = share(a, b);
    double least = INFINITY, most = 0;
    for (int k = 0; k < 3; ++k) least = std::min(least, a.at[k] + b.at[k]), most = std::max(most, a.at[k] + b.at[k]);
    if (least - a.down - b.down >= options_.width) return wide;
    if (most + a.up + b.up <= options_.width) return narrow;
    return larger(wide, narrow);
  }

  double weight(Index v) const {
    const double a = distance_[0][v], b = distance_[1][v];
    return a == 0 ? 0 : std::min(1.0, std::max(a / options_.width, a / (a + b)));
  }

  void weigh(Blended& result) const {
    std::vector<std::uint8_t> corners(mesh_.points().size(), 0);
    for (Index f = 0; f < static_cast<Index>(mesh_.faces().size()); ++f)
      for (int k = 0; k < 3; ++k) {
        const Index v = mesh_.faces()[f][k];
        if (!both(f) || lines_[0].empty()) {
          result.weight.push_back(has(before_, mesh_.label(f), 0));
        } else if (is_corner(v)) {
          result.weight.push_back(weight_at_corner(f, k));
          corners[v] = 1;
        } else {
          result.weight.push_back(weight(v));
        }
      }
    result.report.corners = static_cast<Index>(std::count(corners.begin(), corners.end(), 1));
    if (result.report.corners > 0) result.report.radius = radius_;
  }

  /// As along the edge that lies on a border, else as in the middle of the face.
  double weight_at_corner(Index f, int k) const {
    const auto along = [&](int side, int end) -> double {
      const Index v = mesh_.faces()[f][(k + end) % 3];
      if (is_corner(v)) return 0.5;
      const Index g = mesh_.across(f, (k + side) % 3);
      const bool border = g != none && !both(g);
      return border ? (has(before_, mesh_.label(g), 0) ? 3 : -2) : weight(v);  // beyond 0 and 1: this edge decides
    };
    const double first = along(2, 1), second = along(1, 2);
    const bool one = first > 1 || second > 1, zero = first < 0 || second < 0;
    if (one != zero) return one ? 1 : 0;
    return std::clamp(0.5 * (first + second), 0.0, 1.0);
  }

  void hand_over(Overlay& after) {
    after.rounding = before_.rounding;
    for (const int input : {0, 1}) {
      after.per_corner[input] = true;
      for (Index f = 0; f < static_cast<Index>(mesh_.faces().size()); ++f)
        for (int k = 0; k < 3; ++k) after.heights[input].push_back(mesh_.value(input, f, k));
    }
    for (Index f = 0; f < static_cast<Index>(mesh_.faces().size()); ++f)
      after.parents.push_back(before_.parents[mesh_.label(f)]);
    after.points = mesh_.take_points();
    after.faces = mesh_.take_faces();
  }

  Overlay before_;
  BlendOptions options_;
  BisectedMesh mesh_;
  std::vector<LineDistance> lines_;  // A's border inside B, B's inside A, places where both meet
  std::vector<std::uint8_t> on_[2];  // per vertex
  std::vector<double> distance_[2];  // per vertex, as far as the width
  std::vector<double> from_corner_;  // per vertex, as far as the radius
  double radius_ = 0;
};

}  // namespace

void accumulate(BlendReport& sum, const BlendReport& more) {
  sum.bound = std::max(sum.bound, more.bound);
  sum.made += more.made;
  sum.corners += more.corners;
  sum.radius = std::max(sum.radius, more.radius);
}

Blended blend(Overlay overlay, const BlendOptions& options, Context& context) {
  return Blender(std::move(overlay), options).run(context);
}

}  // namespace terrane
