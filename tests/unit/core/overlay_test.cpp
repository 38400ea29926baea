// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>

#include "core/error.hpp"
#include "core/predicates.hpp"
#include "core/volume.hpp"
#include "support/oracle.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using namespace support;

double area_of(const Overlay& o, bool need_a, bool need_b) {
  double area = 0;
  for (std::size_t f = 0; f < o.faces.size(); ++f) {
    if ((need_a && o.parents[f][0] == none) || (need_b && o.parents[f][1] == none)) continue;
    const Point2 p = o.points[o.faces[f][0]], q = o.points[o.faces[f][1]], r = o.points[o.faces[f][2]];
    area += 0.5 * ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x));
  }
  return area;
}

/// Conforming and valid on the returned doubles: every face positive, every place once, every directed edge once.
void expect_valid(const Overlay& o) {
  std::set<std::pair<double, double>> places;
  for (Point2 p : o.points) EXPECT_TRUE(places.insert({p.x, p.y}).second) << "a place twice: " << p.x << " " << p.y;
  std::set<std::pair<Index, Index>> edges;
  for (const Face& f : o.faces) {
    ASSERT_GT(orientation(o.points[f[0]], o.points[f[1]], o.points[f[2]]), 0);
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(edges.insert({f[k], f[(k + 1) % 3]}).second) << "an edge twice on one side";
  }
}

/// The lowest and highest the surface gets within `radius` of a place; empty (low > high) where it is not that near.
struct Range {
  double low = INFINITY, high = -INFINITY;
};
Range range_around(const Tin& tin, Point2 at, double radius) {
  Range range;
  for (const Face& f : tin.faces) {
    const Point c[3] = {tin.vertices[f[0]], tin.vertices[f[1]], tin.vertices[f[2]]};
    const auto [xmin, xmax] = std::minmax({c[0].x, c[1].x, c[2].x});
    const auto [ymin, ymax] = std::minmax({c[0].y, c[1].y, c[2].y});
    if (at.x < xmin - radius || at.x > xmax + radius || at.y < ymin - radius || at.y > ymax + radius) continue;
    const long double x1 = (long double)c[1].x - c[0].x, y1 = (long double)c[1].y - c[0].y;
    const long double x2 = (long double)c[2].x - c[0].x, y2 = (long double)c[2].y - c[0].y, d = x1 * y2 - x2 * y1;
    const long double w1 = c[1].z - c[0].z, w2 = c[2].z - c[0].z;
    // The point of the face nearest to the place, and its height.
    long double px = at.x, py = at.y, nearest = 0;
    bool inside = true;
    for (int k = 0; k < 3; ++k) inside = inside && orientation(plan(c[k]), plan(c[(k + 1) % 3]), at) >= 0;
    if (!inside) {
      nearest = INFINITY;
      for (int k = 0; k < 3; ++k) {
        const Point p = c[k], q = c[(k + 1) % 3];
        const long double dx = (long double)q.x - p.x, dy = (long double)q.y - p.y;
        const long double t = std::clamp(((at.x - p.x) * dx + (at.y - p.y) * dy) / (dx * dx + dy * dy), 0.0L, 1.0L);
        const long double e = hypotl(p.x + t * dx - at.x, p.y + t * dy - at.y);
        if (e < nearest) nearest = e, px = p.x + t * dx, py = p.y + t * dy;
      }
    }
    if (nearest > radius) continue;
    const long double s = ((px - c[0].x) * y2 - x2 * (py - c[0].y)) / d,
                      t = (x1 * (py - c[0].y) - (px - c[0].x) * y1) / d;
    const long double z = c[0].z + s * w1 + t * w2;
    const long double slope = hypotl((w1 * y2 - w2 * y1) / d, (x1 * w2 - x2 * w1) / d);
    const auto [zmin, zmax] = std::minmax({c[0].z, c[1].z, c[2].z});
    range.low = std::min(range.low, std::max(zmin, static_cast<double>(z - 2 * radius * slope)));
    range.high = std::max(range.high, std::min(zmax, static_cast<double>(z + 2 * radius * slope)));
  }
  return range;
}

/// The promise on heights: at every vertex within the input's range over a disk of 2 delta + 2 tau, plus 4 ulp.
void expect_heights(const Overlay& o, const Tin& a, const Tin& b) {
  const double radius = 2 * o.rounding.max_move + 2 * o.rounding.max_snap;
  std::map<std::pair<int, Index>, Range> known;
  for (std::size_t f = 0; f < o.faces.size(); ++f)
    for (int m = 0; m < 2; ++m) {
      if (o.parents[f][m] == none) continue;
      for (int k = 0; k < 3; ++k) {
        const Index v = o.faces[f][k];
        auto [entry, fresh] = known.try_emplace({m, v});
        if (fresh) entry->second = range_around(m == 0 ? a : b, o.points[v], radius + o.rounding.max_spill);
        const double z = o.height(m, static_cast<Index>(f), k),
                     ulp = std::nextafter(std::fabs(z), INFINITY) - std::fabs(z);
        ASSERT_GE(z, entry->second.low - 4 * ulp) << "input " << m << " face " << f;
        ASSERT_LE(z, entry->second.high + 4 * ulp) << "input " << m << " face " << f;
      }
    }
}

struct Pair {
  std::string name;
  Tin a, b;
};

void expect_overlay_right(const Pair& pair) {
  SCOPED_TRACE(pair.name);
  const Tin a = canonical(pair.a), b = canonical(pair.b);
  Context context;
  const Overlay o = overlay(a, b, {.snap = 0}, context);
  expect_valid(o);
  expect_heights(o, a, b);
  const OracleCounts truth = oracle_counts(a, b);
  EXPECT_EQ(static_cast<std::size_t>(o.rounding.regions), truth.regions);
  const double scale = 1e-9 * std::max(1.0, truth.area);
  EXPECT_NEAR(area_of(o, false, false), truth.area, scale);
  EXPECT_NEAR(area_of(o, true, true), truth.overlap_area, scale);
}

/// Random triangulations of a small integer lattice with faces left out: degeneracy is the rule.
Tin lattice_terrain(std::mt19937_64& dice, int size, double keep) {
  Tin tin;
  const auto id = [&](int i, int j) { return static_cast<Index>(j * (size + 1) + i); };
  const int step = 1 + static_cast<int>(dice() % 2), dx = static_cast<int>(dice() % 3),
            dy = static_cast<int>(dice() % 3);
  for (int j = 0; j <= size; ++j)
    for (int i = 0; i <= size; ++i)
      tin.vertices.push_back(
          {static_cast<double>(dx + i * step), static_cast<double>(dy + j * step), static_cast<double>(dice() % 8)});
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const Index p = id(i, j), q = id(i + 1, j), r = id(i + 1, j + 1), s = id(i, j + 1);
      const bool rising = dice() % 2;
      for (const Face& f : rising ? std::array<Face, 2>{Face{p, q, r}, Face{p, r, s}}
                                  : std::array<Face, 2>{Face{p, q, s}, Face{q, r, s}})
        if (static_cast<double>(dice() % 1000) < 1000 * keep) tin.faces.push_back(f);
    }
  return tin;
}

TEST(overlay, lattice_terrains_with_holes_agree_with_the_exact_arrangement) {
  std::mt19937_64 dice(1);
  for (int round = 0; round < 400; ++round) {
    Pair pair{"round " + std::to_string(round), lattice_terrain(dice, 1 + round % 5, 0.75),
              lattice_terrain(dice, 1 + round % 4, 0.75)};
    if (canonical(pair.a).faces.empty() || canonical(pair.b).faces.empty()) continue;
    expect_overlay_right(pair);
    if (HasFailure()) return;
  }
}

TEST(overlay, paste_keeps_the_faces_of_a_and_covers_the_union) {
  std::mt19937_64 dice(2);
  for (int round = 0; round < 400; ++round) {
    SCOPED_TRACE(round);
    const Tin a = canonical(lattice_terrain(dice, 1 + round % 5, 0.75)),
              b = canonical(lattice_terrain(dice, 1 + round % 4, 0.75));
    if (a.faces.empty() || b.faces.empty()) continue;
    Context context;
    const Overlay o = overlay(a, b, {.refinement = Refinement::paste}, context);
    expect_valid(o);
    expect_heights(o, a, b);
    const OracleCounts truth = oracle_counts(a, b);
    EXPECT_NEAR(area_of(o, false, false), truth.area, 1e-9 * truth.area);
    EXPECT_EQ(area_of(o, true, true), 0);
    std::map<Index, double> per_face;
    for (std::size_t f = 0; f < o.faces.size(); ++f) {
      if (o.parents[f][0] == none) continue;
      const Point2 p = o.points[o.faces[f][0]], q = o.points[o.faces[f][1]], r = o.points[o.faces[f][2]];
      per_face[o.parents[f][0]] += 0.5 * ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x));
    }
    ASSERT_EQ(per_face.size(), a.faces.size());
    for (const auto& [f, area] : per_face) {
      const Point p = a.vertices[a.faces[f][0]], q = a.vertices[a.faces[f][1]], r = a.vertices[a.faces[f][2]];
      EXPECT_NEAR(area, 0.5 * ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x)), 1e-12);
    }
    if (HasFailure()) return;
  }
}

TEST(overlay, faces_of_a_without_a_border_come_back_whole_from_paste) {
  const Tin a = canonical(patch(0, 0, 6, 6, 10)), b = canonical(shifted(random_terrain(300, 3), -4000, -4000));
  Context context;
  const Overlay o = overlay(a, b, {.refinement = Refinement::paste}, context);
  expect_valid(o);
  std::map<Index, int> pieces;
  for (const auto& parent : o.parents)
    if (parent[0] != none) ++pieces[parent[0]];
  int whole = 0;
  for (const auto& [f, count] : pieces) whole += count == 1;
  EXPECT_EQ(pieces.size(), a.faces.size());
  EXPECT_GE(whole, 4 * 4 * 2);  // at least all that do not touch the border
}

TEST(overlay, near_coincidence_is_rounded_to_a_valid_mesh) {
  const Tin t = random_terrain(300, 1), grid = grid_terrain(8, true);
  for (const double offset : {0.0, 1.0}) {
    const auto at = [&](Tin tin) { return shifted(std::move(tin), offset * 500000, offset * 4500000); };
    const std::vector<Pair> pairs = {
        {"jitter 1e-12", at(t), jittered(at(t), 1e-12, false)},
        {"jitter 1e-9", at(t), at(jittered(t, 1e-9, false))},
        {"jitter 1e-9, border too", at(t), at(jittered(t, 1e-9, true))},
        {"jitter 1e-6", at(t), at(jittered(t, 1e-6, false))},
        {"ulp", at(t), ulp_copy(at(t), true)},
        {"steps", at(stepped(300, 1, 1e-7)), at(jittered(stepped(300, 1, 1e-7), 1e-9, false))},
        {"grid against itself rotated", at(grid), at(rotated(grid, 45))}};
    for (const Pair& pair : pairs)
      for (const double snap : {-1.0, 0.0}) {
        SCOPED_TRACE(pair.name + (offset > 0 ? " utm" : "") + (snap == 0 ? " unsnapped" : ""));
        const Tin a = canonical(pair.a), b = canonical(pair.b);
        Context context;
        const Overlay o = overlay(a, b, {.snap = snap}, context);
        expect_valid(o);
        expect_heights(o, a, b);
        EXPECT_LE(o.rounding.max_spill, 3 * o.rounding.max_move + o.rounding.max_snap);
        EXPECT_LT(o.rounding.max_move, 2e-9);
        if (snap == 0) {
          EXPECT_EQ(static_cast<std::size_t>(o.rounding.regions), oracle_counts(a, b).regions);
        }
      }
  }
}

TEST(overlay, the_pairs_that_broke_other_overlays) {
  const Tin t = random_terrain(400, 1), u = random_terrain(400, 2);
  for (const bool utm : {false, true}) {
    const auto at = [&](Tin tin) { return utm ? shifted(std::move(tin), 500000, 4500000) : tin; };
    const std::vector<Pair> pairs = {{"identical", t, shifted(t, 0, 0, 1)},
                                     {"random", t, u},
                                     {"grid flipped", grid_terrain(12, true), grid_terrain(12, false)},
                                     {"grid 12 x 24", grid_terrain(12, true), grid_terrain(24, false)},
                                     {"grid 12 x 13", grid_terrain(12, true), grid_terrain(13, false)},
                                     {"simplified", t, simplified(t)}};
    for (const Pair& pair : pairs) expect_overlay_right({pair.name + (utm ? " utm" : ""), at(pair.a), at(pair.b)});
  }
}

/// Faces around (0, 0), the first corner of the outline at `turn` of a face.
Tin fan(int faces, double turn, double z) {
  Tin tin;
  tin.vertices.push_back({0, 0, 0});
  for (int k = 0; k < faces; ++k) {
    const double angle = 2 * M_PI * (k + turn) / faces;
    tin.vertices.push_back({100 * std::cos(angle), 100 * std::sin(angle), z * (k % 7)});
    tin.faces.push_back({0, k + 1, (k + 1) % faces + 1});
  }
  return tin;
}

TEST(Overlay, FansAroundOnePlace) {
  Context context;
  for (const int faces : {10, 100, 1000}) {
    const Overlay both = overlay(fan(faces, 0, 1), fan(faces, 0.3, 2), {}, context);
    expect_valid(both);
    EXPECT_NEAR(area_of(both, true, false), plan_area(fan(faces, 0, 1)), 1e-6) << faces;
    EXPECT_NEAR(area_of(both, false, true), plan_area(fan(faces, 0.3, 2)), 1e-6) << faces;
  }
}

}  // namespace
}  // namespace terrane
