// SPDX-License-Identifier: GPL-3.0-or-later
// The algebra of true and false against polygon booleans by GEOS, which share nothing with ours but the question.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <vector>

#include "core/logic.hpp"
#include "core/validate.hpp"
#include "core/volume.hpp"
#include "support/checks.hpp"
#include "support/oracle.hpp"
#include "support/polygons.hpp"

namespace terrane {
namespace {

using support::Polygons;
using Rings = std::vector<std::vector<Point2>>;

class RandomPolygons {
 public:
  explicit RandomPolygons(std::uint64_t seed) : random_(seed) {}

  /// Stars with a star-shaped hole, at times with an island in it; or rings on a lattice, where corners touch and edges
  /// lie on each other.
  Polygons next(bool lattice, double shift) {
    Rings rings;
    if (lattice) {
      for (int i = 0, n = 1 + whole(3); i < n; ++i) rings.push_back(on_lattice());
    } else {
      const Point2 centre{uniform(3, 7), uniform(3, 7)};
      const double size = uniform(1, 5);
      rings.push_back(star(centre, size));
      if (whole(2) == 0) rings.push_back(star(centre, 0.3 * size));
      if (whole(3) == 0) rings.push_back(star(centre, 0.08 * size));
    }
    for (auto& ring : rings)
      for (Point2& p : ring) p = {p.x + shift, p.y + 9 * shift};
    return Polygons::from_rings(rings).repaired();
  }

 private:
  double uniform(double a, double b) { return a + (b - a) * static_cast<double>(random_() >> 11) * 0x1p-53; }
  int whole(int n) { return static_cast<int>(random_() % n); }

  std::vector<Point2> star(Point2 centre, double size) {
    const int n = 3 + whole(40);
    std::vector<Point2> ring;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n, radius = size * uniform(0.4, 1);
      ring.push_back({centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)});
    }
    return ring;
  }

  std::vector<Point2> on_lattice() {
    std::vector<Point2> ring;
    for (int i = 0, n = 3 + whole(6); i < n; ++i) ring.push_back({1.0 * whole(7), 1.0 * whole(7)});
    return ring;
  }

  std::mt19937_64 random_;
};

/// Level at 255, as far as the polygons go.
Tin surface(const Polygons& polygons) {
  Tin tin = support::triangulated(polygons.rings());
  for (Point& p : tin.vertices) p.z = 255;
  return tin;
}

double true_area(const Tin& tin) {
  Tin part{tin.vertices, {}};
  for (const Face& f : tin.faces)
    if (tin.vertices[f[0]].z == 255 && !is_wall(tin, f)) part.faces.push_back(f);
  return plan_area(part);
}

struct Law {
  const char* name;
  TruthTable table;
  double (*area)(double shared, double united, double box);
};

constexpr Law laws[] = {
    {"and", {is_false, is_false, is_false, is_true}, [](double s, double, double) { return s; }},
    {"or", {is_false, is_true, is_true, is_true}, [](double, double u, double) { return u; }},
    {"xor", {is_false, is_true, is_true, is_false}, [](double s, double u, double) { return u - s; }},
    {"nand", {is_true, is_true, is_true, is_false}, [](double s, double, double b) { return b - s; }},
    {"nor", {is_true, is_false, is_false, is_false}, [](double, double u, double b) { return b - u; }}};

TEST(LogicLaws, AreasOfPolygonPairsAreThoseOfGeos) {
  int judged = 0, geos_wrong = 0;
  for (std::uint64_t seed = 1; judged < 500; ++seed) {
    RandomPolygons polygons(seed);
    const double shift = seed % 3 == 0 ? 500000 : 0;
    const Polygons first = polygons.next(seed % 2 == 0, shift), second = polygons.next(seed % 4 < 2, shift);
    if (first.area() < 0.1 || second.area() < 0.1) continue;
    ++judged;
    Context context;
    const Tin a = checked(surface(first), "a", context), b = checked(surface(second), "b", context);
    const ZonedMesh zones_a = read_binary(a, {}, context).mesh, zones_b = read_binary(b, {}, context).mesh;
    const Box p = bounds(a), q = bounds(b);
    const double box =
        (std::max(p.xmax, q.xmax) - std::min(p.xmin, q.xmin)) * (std::max(p.ymax, q.ymax) - std::min(p.ymin, q.ymin));
    double shared = first.shared_area(second), united = first.united_area(second);
    const double perimeter = 400, play = 4 * 1e-9 * (shift > 0 ? 1 : 1e-5) * perimeter + 1e-11 * box;
    if (const support::OracleCounts truth = support::oracle_counts(a, b);
        std::fabs(truth.overlap_area - shared) > play || std::fabs(truth.area - united) > play) {
      ++geos_wrong;
      shared = truth.overlap_area, united = truth.area;
    }
    for (const Law& law : laws) {
      const Combined combined = combine(zones_a, zones_b, law.table, Extent::box, context);
      const Tin result = lifted(combined.mesh, std::vector<double>{0, 255}, context).tin;
      ASSERT_EQ(support::wrong_with(result), "") << law.name << " of seed " << seed;
      ASSERT_EQ(support::open_seams(result), "") << law.name << " of seed " << seed;
      EXPECT_NEAR(true_area(result), law.area(shared, united, box), play) << law.name << " of seed " << seed;
      EXPECT_NEAR(plan_area(result), box, play) << law.name << " of seed " << seed;
    }
  }
  std::printf("%d pairs, GEOS wrong on %d\n", judged, geos_wrong);
}

}  // namespace
}  // namespace terrane
