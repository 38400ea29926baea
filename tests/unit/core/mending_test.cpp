// SPDX-License-Identifier: GPL-3.0-or-later
// What mending may not take away: heights beside cliffs, level surfaces, the border of an open mesh.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/overlay.hpp"
#include "core/predicates.hpp"
#include "core/rounding/exterior.hpp"
#include "core/surface.hpp"
#include "support/cells.hpp"
#include "support/height_judge.hpp"
#include "support/overlay_judge.hpp"
#include "support/plan_mesh.hpp"
#include "support/small_mesh.hpp"
#include "unit/core/overlaid.hpp"

namespace terrane {
namespace {

using namespace support;

TEST(mending, a_spill_far_from_the_origin_is_reported_as_large_as_it_is) {
  const Tin a = canonical(
      Tin{{{500000, 4500000.333333333, 5},
           {500000.6666666668, 4500000.3333333321, 2},
           {500002.33333333337, 4500000.3333333349, -2},
           {500000.33333333326, 4500002.666666667, 3},
           {500002.33333333337, 4500003.3333333349, 1},
           {500003.00000000006, 4500002.9999999981, 1},
           {500003.99999999994, 4500003.6666666651, 5},
           {500002.66666666669, 4500001.3333333321, -4},
           {500005, 4500001.3333333321, -2}},
          {{0, 1, 3}, {1, 2, 3}, {2, 4, 3}, {2, 6, 7}, {2, 7, 4}, {2, 8, 6}, {4, 5, 6}, {4, 7, 5}, {5, 7, 6}}});
  const Tin b = canonical(Tin{{{500000.66666666663, 4500000.3333333321, 5},
                               {500001.6666666668, 4500000.3333333321, -3},
                               {500001.6666666668, 4499999.9999999991, -4},
                               {500002.33333333326, 4500000.3333333312, 6},
                               {500004.99999999994, 4500001.3333333349, 2}},
                              {{0, 1, 4}, {0, 2, 1}, {1, 2, 3}, {1, 3, 4}, {2, 4, 3}}});
  const Overlay o = overlaid(a, b);
  for (std::size_t f = 0; f < o.faces.size(); ++f)
    for (const int m : {0, 1})
      if (const Index parent = o.parents[f][m]; parent != none) {
        for (const Index v : o.faces[f])
          EXPECT_TRUE(within(o.points[v], triangle(m == 0 ? a : b, parent), o.rounding.max_spill));
      }
}

TEST(mending, a_spill_beside_a_long_edge_is_reported_as_large_as_it_is) {
  const Tin a = triangle_of({333751.24737673055, 5000520.1799814897, 7}, {334213.40567617374, 5000410.4597219778, 7},
                            {333970.12995360914, 5000468.2154205013, 7});
  const Tin b = canonical(Tin{{{333546.76674895303, 5000568.7253988776, 4.5},
                               {333777.23965276539, 5000506.9231003849, 4.5},
                               {333954.24556405592, 5000473.8929152545, 4.5},
                               {333970.12995360914, 5000468.2154205013, 4.5},
                               {334213.40567617374, 5000410.4597219778, 4.5}},
                              {{0, 3, 2}, {1, 4, 3}}});
  EXPECT_EQ(broken_promises(a, b, {.snap = 0}, overlaid(a, b)), "");
}

/// A is a cliff: a sliver thinner than the rounding of what crosses it, between two fat faces.
TEST(mending, both_sides_of_a_cliff_thinner_than_rounding_keep_their_height) {
  const Tin a = canonical(Tin{{{0.34813236446989482, 0.34375, 490.61696607153522},
                               {0.18973697193380112, 0.640625, -55.369931218183751},
                               {0.2956015594002005, 0.703125, 237.21361907203521},
                               {0.375, 0.75, 342.50775930355724}},
                              {{0, 2, 1}, {1, 2, 3}}});
  const Tin b = canonical(Tin{{{-0.053391027398360213, 0.620092836178886, 147.74410155497029},
                               {0.5, 0.75, 756.99126504121011},
                               {0.43718253458908607, 0.61800729343689453, 120.26653422999664}},
                              {{0, 2, 1}}});
  const Overlay o = overlaid(a, b);
  double truth = 0, found = 0;
  for (const Cell& cell : shared_cells(a, b)) truth += cell.volume;
  for (Index f = 0; f < static_cast<Index>(o.faces.size()); ++f) {
    if (o.parents[f][0] == none || o.parents[f][1] == none) continue;
    const auto at = [&](int k) { return o.points[o.faces[f][k]]; };
    const Point2 p = at(0), q = at(1), r = at(2);
    double z = 0;
    for (int k = 0; k < 3; ++k) z += o.height(0, f, k) - o.height(1, f, k);
    found += ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x)) / 6 * z;
  }
  EXPECT_NEAR(found, truth, 1e-11);
}

TEST(mending, a_report_bounds_the_spill_of_what_was_not_mended) {
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    std::vector<Point> points[2];
    for (auto& some : points)
      for (int k = 0; k < 12; ++k)
        some.push_back({uniform(random, 500000, 500100), uniform(random, 4500000, 4500100), 0});
    const Overlay o = overlaid(canonical(swept(points[0])), canonical(swept(points[1])));
    EXPECT_GE(o.rounding.max_spill, o.rounding.max_move);
    EXPECT_LE(o.rounding.max_spill, 3 * o.rounding.max_move);
  }
}

TEST(snapping, the_nearest_vertex_may_lie_beyond_the_face_that_a_vertex_lies_in) {
  const Tin a = canonical(Tin{{{0, 0, 0}, {10, 0, 0}, {5, 1e-4, 0}, {5, -8, 0}}, {{0, 1, 2}, {0, 3, 1}}});
  const Tin b = triangle_of({5, -1e-4, 1}, {5, -20, 1}, {9, -20, 1});
  const Overlay o = overlaid(a, b, 1e-3);
  EXPECT_EQ(o.rounding.snapped, 1);
  EXPECT_DOUBLE_EQ(o.rounding.max_snap, 2e-4);
  EXPECT_FALSE(has(o, {5, -1e-4}));
}

TEST(snapping, only_vertices_that_are_nearest_to_each_other_become_one) {
  // B's second vertex is nearer to A's (5, 0) than its first, and nearer still to another of A's.
  const Tin a = canonical(Tin{{{5, 0, 0}, {5 + 3e-4, 0, 0}, {5, 9, 0}}, {{0, 1, 2}}});
  const Tin b = canonical(Tin{{{5, -5e-4, 1}, {5 + 2e-4, -1e-5, 1}, {-3, -7, 1}}, {{0, 1, 2}}});
  const Overlay o = overlaid(a, b, 1e-3);
  EXPECT_EQ(o.rounding.snapped, 1);
  EXPECT_TRUE(has(o, {5, -5e-4}));
}

TEST(zero_lines, a_level_surface_stays_level_where_a_steep_one_crosses_it) {
  Random random(5);
  for (int i = 0; i < 300; ++i) {
    std::vector<Point> level, steep;
    for (int k = 0; k < 8; ++k)
      level.push_back({uniform(random, 500000, 500001), uniform(random, 4500000, 4500001), 7});
    for (int k = 0; k < 12; ++k)
      steep.push_back({uniform(random, 500000, 500001), uniform(random, 4500000, 4500001), uniform(random, -900, 900)});
    Context context;
    const Overlay o = split_where_surfaces_cross(overlaid(canonical(swept(steep)), canonical(swept(level))), context);
    for (Index f = 0; f < static_cast<Index>(o.faces.size()); ++f)
      for (int k = 0; k < 3 && o.parents[f][1] != none; ++k) ASSERT_EQ(o.height(1, f, k), 7) << i;
  }
}

/// B has a cliff an ulp wide; where A passes its foot, the crossing must not get a height of its top.
TEST(zero_lines, a_crossing_has_the_height_of_the_edge_that_it_was_made_on) {
  const auto at = [](int i, int j, double z) { return Point{500000 + 1.0 / 3 * i, 4500000 + 1.0 / 3 * j, z}; };
  const Tin a = canonical(Tin{{at(0, 0, 5), at(2, 8, -4), at(5, 12, 2), at(15, 15, 2)}, {{0, 3, 1}, {1, 3, 2}}});
  const Tin b = canonical(Tin{{at(9, 1, 5), at(8, 6, -1), at(3, 14, 2), at(7, 12, 4), at(15, 8, -3)},
                              {{0, 1, 2}, {0, 3, 1}, {0, 4, 3}, {1, 3, 2}, {2, 3, 4}}});
  Context context;
  const Overlay o = split_where_surfaces_cross(overlaid(a, b), context);
  const HeightJudge judge(a);
  for (Index f = 0; f < static_cast<Index>(o.faces.size()); ++f)
    for (int k = 0; k < 3 && o.parents[f][0] != none; ++k)
      EXPECT_TRUE(judge.allows(o.points[o.faces[f][k]], 6 * o.rounding.max_move, o.height(0, f, k), o.parents[f][0]));
}

TEST(mending, where_slivers_narrow_to_an_ulp_every_face_stays_near_its_own) {
  // Slivers of a fan, and the same moved by an ulp.
  const Tin a = canonical(Tin{{{333333.42609119357, 5000001.531952112, -20.24071431159863},
                               {333333.42732063681, 5000001.5333318049, -20.172957722588979},
                               {333333.42855517089, 5000001.5347069455, -20.104509904040476},
                               {333333.42979477911, 5000001.5360775124, -20.035371790973368},
                               {333333.4310394444, 5000001.5374434898, -19.965544327837577},
                               {333333.43228914985, 5000001.5388048561, -19.895028468499714},
                               {333333.44246617501, 5000001.5495276302, -19.306236891610958},
                               {333333.44117676886, 5000001.5482038036, -19.382224455714677},
                               {333333.43989226437, 5000001.5468752207, -19.457531591962123},
                               {333333.43861267908, 5000001.5455418993, -19.532157271632457},
                               {333333.43733803043, 5000001.5442038579, -19.606100475313792},
                               {333333.4360683359, 5000001.5428611152, -19.679360192917066},
                               {333333.43480361276, 5000001.5415136879, -19.751935423689897},
                               {333333.43354387837, 5000001.5401615957, -19.82382517623018},
                               {333333.44376046519, 5000001.5508466819, -19.229569937666639}},
                              {{0, 2, 1}, {0, 4, 3}, {0, 7, 8}, {0, 9, 10}, {0, 11, 12}, {0, 13, 5}, {0, 14, 6}}});
  const Tin b = canonical(
      Tin{{{333333.42609119351, 5000001.5319521129, -22.74071431159863},
           {333333.42979477905, 5000001.5360775134, -22.535371790973368},
           {333333.43103944446, 5000001.5374434916, -22.465544327837577},
           {333333.43228914979, 5000001.5388048561, -22.395028468499714},
           {333333.44246617495, 5000001.5495276293, -21.806236891610958},
           {333333.44117676886, 5000001.5482038017, -21.882224455714677},
           {333333.43989226426, 5000001.5468752217, -21.957531591962123},
           {333333.43861267908, 5000001.5455419002, -22.032157271632457},
           {333333.43733803037, 5000001.5442038598, -22.106100475313792},
           {333333.43606833601, 5000001.5428611143, -22.179360192917066},
           {333333.43480361282, 5000001.5415136889, -22.251935423689897},
           {333333.43354387849, 5000001.5401615947, -22.32382517623018},
           {333333.44376046519, 5000001.5508466829, -21.729569937666639},
           {333333.44505962182, 5000001.5521609401, -21.652224641178151},
           {333333.44636362669, 5000001.5534703871, -21.574202058708259},
           {333333.8000000001, 5000001.2000000011, 27.928250798773647}},
          {{0, 2, 1}, {0, 3, 2}, {0, 5, 6}, {0, 7, 8}, {0, 9, 10}, {0, 11, 3}, {0, 12, 4}, {0, 14, 13}, {0, 15, 14}}});
  Context context;
  const OverlayOptions options{.snap = 0};
  EXPECT_EQ(broken_promises(a, b, options, overlay(a, b, options, context)), "");
}

TEST(mending, a_face_whose_corners_lie_on_the_border_does_not_become_part_of_the_outside) {
  const Tin a = canonical(Tin{{{500000.00000000012, 4500000, 5},
                               {500004.99999999988, 4500008, 6},
                               {500006.00000000006, 4500011.0000000009, -3},
                               {500009.00000000006, 4500008.9999999981, 4},
                               {500009.00000000006, 4500010.9999999981, -1},
                               {500009, 4500003.9999999981, -1},
                               {500009, 4500004, 4},
                               {500009, 4500003, 5}},
                              {{0, 1, 2}, {0, 7, 1}, {2, 3, 4}, {2, 6, 3}, {2, 7, 5}, {3, 5, 7}, {3, 6, 5}}});
  const Tin b = canonical(Tin{{{500000.00000000006, 4499999.9999999991, 0},
                               {500001.00000000006, 4499999.9999999991, 1},
                               {500005.99999999988, 4500011.0000000009, -3},
                               {500011.00000000012, 4500012, -1},
                               {500009.00000000012, 4500004, 4},
                               {500008.99999999994, 4500003.9999999981, -4},
                               {500009, 4500003.9999999981, -1}},
                              {{0, 1, 2}, {2, 4, 3}, {2, 5, 6}, {2, 6, 4}, {3, 4, 6}}});
  EXPECT_EQ(broken_promises(a, b, {.snap = 0}, overlaid(a, b)), "");
}

TEST(mending, what_becomes_part_of_the_outside_goes_back_to_a_region_that_has_no_face_left) {
  const Tin a = canonical(Tin{{{500000.00000000012, 4499999.9999999981, 5},
                               {500001.66666666657, 4500002.666666667, 6},
                               {500002.00000000006, 4500003.6666666679, -3},
                               {500003.00000000006, 4500002.9999999981, 4},
                               {500003.00000000006, 4500003.6666666651, -1},
                               {500003, 4500001.333333333, 4},
                               {500003, 4500001.3333333312, -1},
                               {500003, 4500001, 5}},
                              {{0, 1, 2}, {0, 7, 1}, {2, 3, 4}, {2, 5, 3}, {2, 7, 6}, {3, 5, 6}, {3, 6, 7}}});
  const Tin b = canonical(Tin{{{500000.00000000006, 4499999.9999999991, 0},
                               {500000.33333333337, 4499999.9999999991, 1},
                               {500001.99999999988, 4500003.6666666679, -3},
                               {500003.6666666668, 4500004, -1},
                               {500003.00000000012, 4500001.333333333, 4},
                               {500002.99999999994, 4500001.3333333312, -4},
                               {500003, 4500001.3333333312, -1}},
                              {{0, 1, 2}, {2, 4, 3}, {2, 5, 6}, {2, 6, 4}, {3, 4, 6}}});
  EXPECT_EQ(broken_promises(a, b, {.snap = 0}, overlaid(a, b)), "");
}

TEST(mending, a_wedge_two_ulps_wide_does_not_become_part_of_the_outside) {
  const Tin a = canonical(Tin{{{499999.99999999994, 4499999.9999999981, 6},
                               {500000, 4500000, 3},
                               {500000.00000000006, 4499999.9999999981, 2},
                               {500006.00000000006, 4500011.0000000009, -3},
                               {500009, 4500003.9999999981, 2},
                               {500009, 4500003, 5},
                               {500009.00000000012, 4500005, 3},
                               {500007.00000000012, 4500000, 0}},
                              {{0, 2, 1}, {1, 2, 3}, {2, 7, 3}, {3, 4, 6}, {4, 5, 6}}});
  const Tin b = canonical(Tin{{{500000.00000000006, 4500000, 6},
                               {500003.99999999988, 4500011, 2},
                               {500004.99999999988, 4500008, -3},
                               {500006.00000000006, 4500010.9999999981, 3},
                               {500008.99999999994, 4500010.9999999981, 3},
                               {500009.00000000012, 4500004, 2},
                               {500009.00000000006, 4500004.9999999981, 1},
                               {500010.00000000006, 4500001.0000000009, 4}},
                              {{0, 2, 1}, {0, 4, 2}, {0, 5, 6}, {1, 3, 4}, {4, 5, 7}, {4, 6, 5}}});
  EXPECT_EQ(broken_promises(a, b, {.snap = 0}, overlaid(a, b)), "");
}

TEST(mending, the_border_runs_along_two_edges_that_are_an_ulp_long) {
  const Tin a = canonical(Tin{{{500000.00000000006, 4499999.9999999981, 2},
                               {500000.00000000012, 4500000, 3},
                               {500000.66666666669, 4500002.666666667, 4},
                               {500002, 4500003.666666667, -3},
                               {500003.00000000012, 4500001.333333333, -1},
                               {500003, 4500001.3333333312, 2},
                               {500003.00000000012, 4500001.666666667, 3}},
                              {{0, 2, 1}, {0, 3, 2}, {0, 5, 3}, {3, 4, 6}, {3, 5, 4}}});
  const Tin b = canonical(Tin{{{499999.99999999994, 4500000.0000000019, -4},
                               {500002.00000000006, 4500003.0000000009, -3},
                               {500002.00000000006, 4500003.6666666679, 3}},
                              {{0, 1, 2}}});
  EXPECT_EQ(broken_promises(a, b, {.snap = 0}, overlaid(a, b)), "");
}

TEST(mending, a_vertex_on_its_way_passes_a_bad_face_of_another_cluster) {
  const Tin a = canonical(Tin{{{500000.00000000006, 4500000, 5},
                               {500000, 4500000.0000000019, 2},
                               {500000.66666666663, 4500002.6666666651, 2},
                               {500005, 4500005, -1},
                               {500005.00000000012, 4500004.9999999981, 2},
                               {500005.00000000006, 4500004.9999999981, 3}},
                              {{0, 4, 1}, {1, 5, 2}, {2, 5, 3}, {3, 5, 4}}});
  const Tin b = canonical(Tin{{{499999.99999999988, 4499999.9999999981, 2},
                               {500000, 4500000, 3},
                               {500000.66666666663, 4500004.9999999981, 6},
                               {500000.66666666674, 4500005.0000000019, -4},
                               {500005.00000000006, 4500004.9999999981, 2},
                               {500004, 4500003, 4},
                               {500002.66666666669, 4500002.333333333, -1}},
                              {{0, 5, 1}, {1, 2, 3}, {1, 5, 6}, {1, 6, 2}, {2, 6, 3}, {3, 5, 4}, {3, 6, 5}}});
  EXPECT_EQ(broken_promises(a, b, {.snap = 0}, overlaid(a, b)), "");
}

TEST(exterior, a_vertex_passes_the_border_and_goes_under_nothing_that_lies_beyond) {
  // The centre of a square goes down through its lower side to (2, -1); there may be a triangle below.
  for (const bool more : {false, true}) {
    PlanarMesh mesh{{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}, {0, -0.5}, {4, -0.5}, {2, -4}},
                    {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {5, 7, 6}},
                    {},
                    {0, 1, 2, 3, 4}};
    if (!more) mesh.faces.pop_back(), mesh.labels.pop_back();
    connect(mesh);
    add_exterior(mesh, [](Index) { return ExactPlace{}; });
    mesh.points[4] = {2, -1};
    const auto place = [](Index v) {
      ExactPlace at;
      if (v == 4) at.kind = ExactPlace::lattice, at.p = {2, 2};
      return at;
    };
    Context context;
    round_and_verify(mesh, place, context);
    double all = 0, labelled = 0;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      const Face& c = mesh.faces[f];
      if (c[0] == none) continue;
      const double area = 0.5 * area2_accurate(mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]]);
      EXPECT_GT(area, 0);
      all += area;
      if (mesh.labels[f] != none) labelled += area;
    }
    // All positive, and together as large as the box: no two overlap.
    const Point2 low = mesh.points[8], high = mesh.points[10];
    EXPECT_DOUBLE_EQ(all, (high.x - low.x) * (high.y - low.y));
    EXPECT_GE(labelled, more ? 23 : 17);
  }
}

}  // namespace
}  // namespace terrane
