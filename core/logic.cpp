// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/logic.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "core/box.hpp"
#include "core/corner_heights.hpp"
#include "core/error.hpp"
#include "core/level_cuts.hpp"
#include "core/shortest.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

constexpr double steep = 572.9572133543032;  // the tangent of 89.9 degrees

bool one_height(double a, double b) { return std::fabs(a - b) <= std::max(rounding_jump(a), rounding_jump(b)); }

/// Tells level faces from steep ones.
class Reader {
 public:
  Reader(const Tin& tin, const BinaryRule& rule) : tin_(tin), rule_(rule) {}

  /// The two levels; throws where some face belongs to neither.
  Binary levels() const {
    Binary found;
    found.lower = INFINITY, found.upper = -INFINITY;
    std::vector<std::size_t> level;
    for (std::size_t f = 0; f < tin_.faces.size(); ++f) {
      if (is_wall(tin_, tin_.faces[f])) continue;
      const double a = z(f, 0), b = z(f, 1), c = z(f, 2);
      if (one_height(a, b) && one_height(b, c) && one_height(c, a)) {
        level.push_back(f);
      } else {
        if (!is_steep(f))
          refuse(f, "is neither level nor steeper than 89.9 degrees: its corners are at " + shortest(a) + ", " +
                        shortest(b) + " and " + shortest(c));
        continue;
      }
      found.lower = std::min({found.lower, a, b, c}), found.upper = std::max({found.upper, a, b, c});
    }
    if (level.empty())
      throw Error(ErrorKind::input, "not-binary",
                  "'" + rule_.name + "' is no binary surface: no face of it is level; " + remedy);
    for (const std::size_t f : level)
      if (!one_height(z(f, 0), found.lower) && !one_height(z(f, 0), found.upper))
        refuse(f, "lies at " + shortest(z(f, 0)) + ", between the levels " + shortest(found.lower) + " and " +
                      shortest(found.upper));
    found.one_level = one_height(found.lower, found.upper);
    return found;
  }

 private:
  static constexpr const char* remedy = "make it one with 'threshold'";

  double z(std::size_t f, int corner) const { return tin_.vertices[tin_.faces[f][corner]].z; }

  bool is_steep(std::size_t f) const {
    const Face& face = tin_.faces[f];
    const Point &a = tin_.vertices[face[0]], &b = tin_.vertices[face[1]], &c = tin_.vertices[face[2]];
    if (rule_.slope) return rule_.slope(a, b, c) > steep;
    return slope_of_triangle({plan(a), plan(b), plan(c)}, {a.z, b.z, c.z}) > steep;
  }

  [[noreturn]] void refuse(std::size_t f, const std::string& why) const {
    Point2 middle;
    for (const Index v : tin_.faces[f]) middle.x += tin_.vertices[v].x / 3, middle.y += tin_.vertices[v].y / 3;
    throw Error(ErrorKind::input, "not-binary",
                "'" + rule_.name + "' is no binary surface: face " + std::to_string(f) + ", around " +
                    shortest(middle.x) + ", " + shortest(middle.y) + ", " + why + "; " + remedy);
  }

  const Tin& tin_;
  const BinaryRule& rule_;
};

/// An order by content, so that (a, b) and (b, a) take the same path; of places first: NOT changes none.
bool content_before(const ZonedMesh& a, const ZonedMesh& b) {
  if (a.points.size() != b.points.size()) return a.points.size() < b.points.size();
  if (a.faces.size() != b.faces.size()) return a.faces.size() < b.faces.size();
  const auto before = [](Point2 p, Point2 q) { return std::tie(p.x, p.y) < std::tie(q.x, q.y); };
  const auto differs = std::mismatch(a.points.begin(), a.points.end(), b.points.begin());
  if (differs.first != a.points.end()) return before(*differs.first, *differs.second);
  return a.faces != b.faces ? a.faces < b.faces : a.zone < b.zone;
}

ZonedMesh rectangle(const Box& box) {
  return {{{box.xmin, box.ymin}, {box.xmax, box.ymin}, {box.xmax, box.ymax}, {box.xmin, box.ymax}},
          {{0, 1, 2}, {0, 2, 3}},
          {0, 0},
          {}};
}

}  // namespace

Binary read_binary(const Tin& tin, const BinaryRule& rule, Context& context) {
  context.progress("levels", 0);
  Binary binary = Reader(tin, rule).levels();
  const double middle[1] = {binary.lower + (binary.upper - binary.lower) / 2};
  if (binary.one_level) {
    // No height counts but the level's.
    LevelZones zones = level_zones(tin, {}, context);
    const Truth truth = middle[0] >= rule.mean ? is_true : is_false;
    binary.mesh = std::move(zones.mesh);
    std::fill(binary.mesh.zone.begin(), binary.mesh.zone.end(), truth);
    return binary;
  }
  LevelZones zones = level_zones(tin, middle, context);
  binary.mesh = std::move(zones.mesh);
  binary.rounding = zones.rounding;
  return binary;
}

Combined combine(const ZonedMesh& a, const ZonedMesh& b, const TruthTable& table, Extent extent, Context& context) {
  const bool swap = content_before(b, a);
  Combined result;
  const auto fold = [&](Index x, Index y) -> Index {
    if (extent == Extent::overlap && (x == none || y == none)) return none;
    return table[2 * (x == is_true) + (y == is_true)];
  };
  result.mesh = fold_zones(swap ? b : a, swap ? a : b, fold, result.rounding, context);
  if (extent == Extent::overlap) return result;
  const auto fill = [&](Index x, Index) { return x == none ? Index{table[0]} : x; };
  const ZonedMesh ground = rectangle(around(box_of(a.points), box_of(b.points)));
  result.mesh = fold_zones(result.mesh, ground, fill, result.rounding, context);
  return result;
}

}  // namespace terrane
