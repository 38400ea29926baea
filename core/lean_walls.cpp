// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/lean_walls.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/box.hpp"
#include "core/corner_heights.hpp"
#include "core/error.hpp"
#include "core/mosaic.hpp"
#include "core/plan/region_fill.hpp"
#include "core/plan_grid.hpp"
#include "core/predicates.hpp"
#include "core/rounding/rounding.hpp"
#include "core/surface/single_valued.hpp"
#include "core/triangle_height.hpp"
#include "core/validate.hpp"

namespace terrane {
namespace {

/// Faces side by side around a place that agree about its height, counter-clockwise.
struct Sector {
  Index place;
  std::vector<Index> corners;      // 3 * face + corner
  bool border_right, border_left;  // whether the domain ends there; else it is a wall, or the other part of a ring
  Index vertex;                    // that it has from now on
  bool left_border = false;        // the vertex draws back from the border, which keeps the place
};

/// A vertex that draws back. Lengths as the metric has them.
struct Foot {
  std::size_t sector;
  Point2 direction;  // in plan units, per unit of length
  double length, offset;
};

class Leaner {
 public:
  Leaner(CornerSurface surface, double offset, const PlanMetric& metric)
      : surface_(std::move(surface)), offset_(offset), metric_(metric), mesh_{surface_.points, surface_.faces, {}, {}} {
    connect(mesh_);
    corner_vertex_.resize(surface_.z.size());
    for (std::size_t c = 0; c < corner_vertex_.size(); ++c) corner_vertex_[c] = surface_.faces[c / 3][c % 3];
    height_.resize(surface_.points.size());
    points_.assign(surface_.points.begin(), surface_.points.end());
    part();
    draw_back();
  }

  /// None when no lean is small enough to be valid.
  std::optional<Leaned> run(Context& context) {
    for (int round = 0; round < 12; ++round) {
      context.progress("lean", 0.5);
      if (!keep_positive()) return {};
      if (auto tin = filled()) {
        Leaned result{canonical(*std::move(tin), context), feet_.size(), 0, 0, 0};
        const Inspection seen = inspect(result.tin, context);
        if (seen.inverted + seen.degenerate + seen.t_junctions + seen.non_manifold_edges + seen.overlaps == 0) {
          for (const Foot& foot : feet_) {
            result.max_move = std::max(result.max_move, foot.length);
            result.min_offset = result.min_offset == 0 ? foot.offset : std::min(result.min_offset, foot.offset);
          }
          return result;
        }
      }
      for (Foot& foot : feet_) shorten(foot);
    }
    return {};
  }

 private:
  double z(Index corner) const { return surface_.z[corner]; }
  Point2 place_of(Index corner) const { return surface_.points[surface_.faces[corner / 3][corner % 3]]; }
  static Index next(Index corner) { return corner - corner % 3 + (corner + 1) % 3; }
  static Index previous(Index corner) { return corner - corner % 3 + (corner + 2) % 3; }

  /// The corner at the same place in the face across the side that ends (left) or begins (right) there; none.
  Index beside(Index corner, bool left) const {
    const Index f = corner / 3, g = mesh_.neighbours[f][(left ? next(corner) : previous(corner)) % 3];
    if (g == none) return none;
    const Index v = surface_.faces[f][corner % 3];
    for (int k = 0; k < 3; ++k)
      if (surface_.faces[g][k] == v) return 3 * g + k;
    return none;
  }

  /// Divides the faces around every place of several heights into sectors.
  void part() {
    const CornersByPlace places = corners_by_place(surface_.faces, surface_.points.size());
    std::vector<std::uint8_t> done(surface_.z.size(), 0);
    for (Index p = 0; p < static_cast<Index>(surface_.points.size()); ++p) {
      const auto first = places.corners.begin() + static_cast<std::ptrdiff_t>(places.first[p]);
      const auto last = places.corners.begin() + static_cast<std::ptrdiff_t>(places.first[p + 1]);
      if (first == last) continue;
      double highest = surface_.z[*first];
      bool several = false;
      for (auto c = first; c != last; ++c) {
        several = several || surface_.z[*c] != surface_.z[*first];
        highest = std::max(highest, surface_.z[*c]);
      }
      height_[p] = highest;
      if (!several) continue;
      const std::size_t first_sector = sectors_.size();
      for (auto c = first; c != last; ++c)
        if (!done[*c]) add_fan(static_cast<Index>(*c), done);
      for (std::size_t s = first_sector; s < sectors_.size(); ++s) {
        if (z(sectors_[s].corners[0]) == highest) continue;
        sectors_[s].vertex = static_cast<Index>(points_.size());
        sector_of_.push_back(s);
        points_.push_back(surface_.points[p]);
        height_.push_back(0);
        for (const Index c : sectors_[s].corners) corner_vertex_[c] = sectors_[s].vertex;
      }
    }
  }

  /// All faces around a place that can be reached from one, from the border of the domain on the right or in a ring.
  void add_fan(Index corner, std::vector<std::uint8_t>& done) {
    Index start = corner;
    for (Index c = beside(start, false); c != none && c != corner; c = beside(start, false)) start = c;
    const bool ring = beside(start, false) != none;
    // A ring begins where the height changes, if it does.
    const Index last = start;
    while (ring && z(beside(start, false)) == z(start)) {
      start = beside(start, false);
      if (start == last) break;
    }
    fans_.push_back({sectors_.size(), 0, ring});
    Index c = start;
    do {
      const Index right = beside(c, false);
      if (sectors_.size() == fans_.back().first || z(right) != z(c)) {
        sectors_.push_back({surface_.faces[c / 3][c % 3], {}, right == none, false, surface_.faces[c / 3][c % 3]});
        ++fans_.back().count;
      }
      sectors_.back().corners.push_back(c);
      sectors_.back().border_left = beside(c, true) == none;
      done[c] = 1;
      c = beside(c, true);
    } while (c != none && c != start);
  }

  /// In units of the metric, seen from a place.
  Point2 towards(Point2 from, Point2 to) const {
    const Point2 unit = metric_.at(from.y);
    return {(to.x - from.x) * unit.x, (to.y - from.y) * unit.y};
  }

  void draw_back() {
    for (std::size_t s = 0; s < sectors_.size(); ++s) {
      const Sector& sector = sectors_[s];
      if (sector.vertex == sector.place) continue;
      const Point2 p = surface_.points[sector.place];
      double angle = 0;
      for (const Index c : sector.corners) {
        const Point2 u = towards(p, place_of(next(c))), v = towards(p, place_of(previous(c)));
        angle += std::atan2(u.x * v.y - u.y * v.x, u.x * v.x + u.y * v.y);
      }
      const Point2 right = towards(p, place_of(next(sector.corners.front())));
      const Point2 left = towards(p, place_of(previous(sector.corners.back())));
      const double begin = std::atan2(right.y, right.x);
      double at = begin + angle / 2, apart = angle / 2;  // the direction, and its angle with the nearest wall
      double most = INFINITY;
      if (sector.border_right != sector.border_left) {
        const double end = std::atan2(left.y, left.x);
        constexpr double square = std::numbers::pi / 2;
        if (angle <= 1.5 * square) {  // along the border
          at = sector.border_right ? begin : end;
          apart = angle;
          const Point2 along = sector.border_right ? right : left;
          most = 0.5 * std::hypot(along.x, along.y);
        } else {  // square to the wall, or in the middle where the border turns back
          const double turn = std::max(square, angle / 2);
          at = sector.border_right ? end - turn : begin + turn;
          apart = square;
          sectors_[s].left_border = true;
        }
      }
      // Beyond a right angle a bisector is as far from both as it is long.
      const double sine =
          sector.border_right != sector.border_left || apart < std::numbers::pi / 2 ? std::sin(apart) : 1;
      const double length = std::min(offset_ / sine, most);
      const Point2 unit = metric_.at(p.y);
      feet_.push_back({s, {std::cos(at) / unit.x, std::sin(at) / unit.y}, length, length * sine});
      place(feet_.back());
    }
  }

  void place(const Foot& foot) {
    const Sector& sector = sectors_[foot.sector];
    const Point2 p = surface_.points[sector.place];
    const Point2 at{p.x + foot.length * foot.direction.x, p.y + foot.length * foot.direction.y};
    points_[sector.vertex] = at;
    double least = INFINITY;
    for (const Index c : sector.corners) {
      const Index f = c / 3;
      const Point2 corners[3] = {place_of(3 * f), place_of(3 * f + 1), place_of(3 * f + 2)};
      const double d = distance_to_triangle(corners, at);
      if (d >= least) continue;
      least = d;
      height_[sector.vertex] = height_on_triangle(corners, {z(3 * f), z(3 * f + 1), z(3 * f + 2)}, at);
    }
  }

  void shorten(Foot& foot) {
    foot.length /= 2;
    foot.offset /= 2;
    place(foot);
  }

  int sign(Index f) const {
    const auto at = [&](int k) { return points_[corner_vertex_[3 * f + k]]; };
    return orientation(at(0), at(1), at(2));
  }

  /// Halves moves until every face is positive; false when that does not help.
  bool keep_positive() {
    std::vector<Index> foot_of(points_.size(), none);
    for (std::size_t i = 0; i < feet_.size(); ++i) foot_of[sectors_[feet_[i].sector].vertex] = static_cast<Index>(i);
    std::vector<Index> faces;
    for (const Foot& foot : feet_)
      for (const Index c : sectors_[foot.sector].corners) faces.push_back(c / 3);
    for (int round = 0; round < 20; ++round) {
      std::vector<Index> shortened;
      for (const Index f : faces) {
        if (sign(f) > 0) continue;
        for (int k = 0; k < 3; ++k)
          if (const Index foot = foot_of[corner_vertex_[3 * f + k]]; foot != none) shortened.push_back(foot);
      }
      if (shortened.empty()) return true;
      std::sort(shortened.begin(), shortened.end());
      shortened.erase(std::unique(shortened.begin(), shortened.end()), shortened.end());
      for (const Index foot : shortened) shorten(feet_[foot]);
    }
    return false;
  }

  /// The vertex that the border of the domain has where a sector's would be.
  Index on_border(Index vertex, Index place) const {
    return vertex != place &&
                   sectors_[sector_of_[static_cast<std::size_t>(vertex) - surface_.points.size()]].left_border
               ? place
               : vertex;
  }

  /// The surface and what fills it where it opened; none when that has no sound border.
  std::optional<Tin> filled() const {
    std::vector<BorderEdge> border;
    const auto add = [&](Index from, Index to) {
      if (from != to) border.push_back({from, to});
    };
    for (Index f = 0; f < static_cast<Index>(surface_.faces.size()); ++f)
      for (int k = 0; k < 3; ++k) {
        const Index g = mesh_.neighbours[f][k];
        const Index from = corner_vertex_[3 * f + (k + 1) % 3], to = corner_vertex_[3 * f + (k + 2) % 3];
        if (g == none) {
          const Index outer_from = on_border(from, surface_.faces[f][(k + 1) % 3]);
          const Index outer_to = on_border(to, surface_.faces[f][(k + 2) % 3]);
          if (outer_from == from && outer_to == to) continue;
          add(to, from);
          add(outer_from, outer_to);
          continue;
        }
        int j = 0;
        while (surface_.faces[g][(j + 1) % 3] != surface_.faces[f][(k + 2) % 3]) ++j;
        const bool open = corner_vertex_[3 * g + (j + 2) % 3] != from || corner_vertex_[3 * g + (j + 1) % 3] != to;
        if (open) add(to, from);
      }
    // Where walls end at the border of the domain.
    for (const Fan& fan : fans_) {
      if (fan.ring || fan.count < 2) continue;
      const Sector &first = sectors_[fan.first], &last = sectors_[fan.first + fan.count - 1];
      bool stays = false;
      for (std::size_t s = fan.first; s < fan.first + fan.count; ++s)
        stays = stays || sectors_[s].vertex == sectors_[s].place;
      const Index from = on_border(last.vertex, last.place), to = on_border(first.vertex, first.place);
      if (stays) {
        add(from, last.place);
        add(first.place, to);
      } else {
        add(from, to);
      }
    }
    FilledRegion fill;
    if (!border.empty()) {
      fill = fill_region(points_, border);
      if (!fill.sound) return {};
    }
    Tin tin;
    for (std::size_t v = 0; v < points_.size(); ++v) tin.vertices.push_back({points_[v].x, points_[v].y, height_[v]});
    for (std::size_t f = 0; f < surface_.faces.size(); ++f)
      tin.faces.push_back({corner_vertex_[3 * f], corner_vertex_[3 * f + 1], corner_vertex_[3 * f + 2]});
    tin.faces.insert(tin.faces.end(), fill.faces.begin(), fill.faces.end());
    return tin;
  }

  struct Fan {
    std::size_t first, count;  // its sectors
    bool ring;
  };

  CornerSurface surface_;
  double offset_;
  const PlanMetric& metric_;
  PlanarMesh mesh_;
  std::vector<Sector> sectors_;
  std::vector<Fan> fans_;
  std::vector<Foot> feet_;
  std::vector<std::size_t> sector_of_;  // of each vertex that was drawn back
  Array<Point2> points_;                // by vertex: places, and those that were drawn back
  std::vector<double> height_;          // by vertex
  std::vector<Index> corner_vertex_;
};

}  // namespace

Leaned lean_walls(const Tin& tin, double offset, const PlanMetric& metric, Context& context) {
  if (!(offset > 0) || single_valued(piece_of(tin, 0).surface)) return {tin, 0, 0, 0, 0};
  if (auto leaned = Leaner(piece_of(tin, 0).surface, offset, metric).run(context)) return *std::move(leaned);
  // Slivers an ulp wide leave no room. On a grid far finer than the walls will be wide they are gone.
  const Box box = bounds(tin.vertices, context);
  const Point2 low = metric.at(box.ymin), high = metric.at(box.ymax);
  const double step = offset / 64 / std::max({low.x, low.y, high.x, high.y});
  const OnGrid coarser = put_on_grid(tin, PlanGrid(step), context);
  if (single_valued(piece_of(coarser.tin, 0).surface)) return {coarser.tin, 0, 0, 0, coarser.rounding.max_move};
  if (auto leaned = Leaner(piece_of(coarser.tin, 0).surface, offset, metric).run(context)) {
    leaned->max_shift = coarser.rounding.max_move;
    return *std::move(leaned);
  }
  throw Error(ErrorKind::input, "wall-offset",
              "walls cannot be leaned by wall-offset: surfaces beside them are too narrow; use less, or 0 for vertical "
              "walls");
}

}  // namespace terrane
