// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rounding/rounding.hpp"

#include <CGAL/Exact_rational.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/error.hpp"
#include "core/overlay.hpp"
#include "core/predicates.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using namespace support;
using Rational = CGAL::Exact_rational;

/// The distance of rounded(place) from the place, in rational arithmetic to the end.
double move_of(const ExactPlace& c) {
  const auto distance = [&](Point2 v) -> Rational {
    return (Rational(c.q.x) - Rational(c.p.x)) * (Rational(v.y) - Rational(c.p.y)) -
           (Rational(c.q.y) - Rational(c.p.y)) * (Rational(v.x) - Rational(c.p.x));
  };
  const Rational at_r = distance(c.r), t = at_r / (at_r - distance(c.s));
  const Point2 got = rounded(c);
  const Rational dx = Rational(c.r.x) + t * (Rational(c.s.x) - Rational(c.r.x)) - Rational(got.x);
  const Rational dy = Rational(c.r.y) + t * (Rational(c.s.y) - Rational(c.r.y)) - Rational(got.y);
  return std::hypot(CGAL::to_double(dx), CGAL::to_double(dy));
}

TEST(rounding, crossings_move_less_than_a_micrometre_at_coordinates_up_to_ten_million) {
  std::mt19937_64 random(1);
  const auto uniform = [&](double low, double high) { return low + (high - low) * double(random() >> 11) * 0x1p-53; };
  int crossings = 0;
  for (const double length : {1e-3, 1.0, 1e3, 1e5, 2e5, 1e6, 1e7})
    for (const double thin : {1.0, 1e-6, 1e-12})  // lines that all but coincide cross just as well
      for (int i = 0; i < 300; ++i) {
        const double cx = uniform(-1e7 + length, 1e7 - length), cy = uniform(-1e7 + length, 1e7 - length);
        const auto near = [&](double x, double y) { return Point2{cx + x * length, cy + y * length}; };
        const double a = uniform(-1, 1), b = uniform(-1, 1);
        const ExactPlace c{ExactPlace::crossing, near(-1, a), near(1, b), near(-0.9, a + thin * uniform(0, 1)),
                           near(0.9, b - thin * uniform(0, 1))};
        const int r = orientation(c.p, c.q, c.r), s = orientation(c.p, c.q, c.s);
        if (r * s >= 0 || orientation(c.r, c.s, c.p) * orientation(c.r, c.s, c.q) >= 0) continue;
        ++crossings;
        ASSERT_LE(move_of(c), rounding_bound(c)) << length << " " << thin;
        ASSERT_LE(rounding_bound(c), 1e-6);
      }
  EXPECT_GT(crossings, 2000);
}

TEST(rounding, every_result_says_how_far_it_moved_anything) {
  const double scale = 1e7 / side;  // edges of hundreds of kilometres, coordinates up to 1e7
  const auto scaled = [&](Tin tin) {
    for (Point& p : tin.vertices) p.x *= scale, p.y *= scale;
    return canonical(without_bad_faces(tin));
  };
  const Tin a = scaled(random_terrain(300, 1));
  for (const Tin& b : {scaled(random_terrain(300, 2)), canonical(ulp_copy(a, true)), canonical(jittered(a, 1e-8, true)),
                       canonical(jittered(a, 3e-8, true))})
    for (const double snap : {-1.0, 0.0}) {
      Context context;
      const RoundingReport report = overlay(a, b, {.snap = snap}, context).rounding;
      EXPECT_LE(report.max_move, 1e-6);
      EXPECT_LE(report.max_snap, 1e-6);
      EXPECT_LE(report.max_spill, std::min(1e-6, 3 * report.max_move + report.max_snap));
    }
}

/// Near-coincident meshes whose bad faces hang together in one cluster: the slow way, all of it.
TEST(rounding, percolated_clusters_come_out_valid_with_input_vertices_where_they_were) {
  const Tin t = random_terrain(1000, 1);
  for (const double offset : {0.0, 1.0})
    for (const double jitter : {1e-12, 1e-11, 1e-10, 1e-9, 1e-8}) {
      const Tin a = canonical(shifted(t, offset * 500000, offset * 4500000));
      const Tin b = canonical(without_bad_faces(jittered(a, jitter, true)));
      SCOPED_TRACE(jitter);
      Context context;
      const Overlay o = overlay(a, b, {.snap = 0}, context);
      for (const Face& f : o.faces) ASSERT_GT(orientation(o.points[f[0]], o.points[f[1]], o.points[f[2]]), 0);
      EXPECT_LE(o.rounding.max_spill, 3 * o.rounding.max_move);
      std::vector<std::pair<double, double>> places;
      for (const Point2 p : o.points) places.emplace_back(p.x, p.y);
      std::sort(places.begin(), places.end());
      EXPECT_EQ(std::adjacent_find(places.begin(), places.end()), places.end());
      for (const Tin* input : {&a, &b})
        for (const Point& p : input->vertices)
          ASSERT_TRUE(std::binary_search(places.begin(), places.end(), std::pair(p.x, p.y)));
    }
}

/// A square whose centre goes to a corner of the plane of the test's choosing.
PlanarMesh fan(Point2 centre) {
  PlanarMesh mesh{
      {{0, 0}, {4, 0}, {4, 4}, {0, 4}, centre}, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}, {}, {0, 1, 2, 3}};
  connect(mesh);
  return mesh;
}

TEST(rounding, a_vertex_that_meets_another_becomes_one_with_it) {
  PlanarMesh mesh = fan({4, 4});
  const auto place = [](Index v) {
    ExactPlace at;
    if (v == 4) at.kind = ExactPlace::lattice, at.p = {2, 2};
    return at;
  };
  Context context;
  const Rounded result = round_and_verify(mesh, place, context);
  EXPECT_EQ(result.merged_into[4], 2);
  EXPECT_EQ(result.report.merges, 1);
  EXPECT_DOUBLE_EQ(result.report.max_move, std::sqrt(8.0));
  int live = 0;
  for (const Face& f : mesh.faces) {
    if (f[0] == none) continue;
    ++live;
    EXPECT_GT(orientation(mesh.points[f[0]], mesh.points[f[1]], mesh.points[f[2]]), 0);
  }
  EXPECT_EQ(live, 2);
}

TEST(rounding, a_border_that_would_have_to_move_is_refused_with_its_place) {
  PlanarMesh mesh = fan({2, 2});
  mesh.points[1] = {-1, 5};  // input, and turned over: nothing may be done about it
  const auto place = [](Index) { return ExactPlace{}; };
  Context context;
  try {
    round_and_verify(mesh, place, context);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::input);
    EXPECT_EQ(error.code, "rounding");
    EXPECT_NE(std::string(error.what()).find("near "), std::string::npos);
  }
}

}  // namespace
}  // namespace terrane
