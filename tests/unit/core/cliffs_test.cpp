// SPDX-License-Identifier: GPL-3.0-or-later
// A face thinner than rounding may be a cliff. Mending it away brings faces of
// its two sides to one vertex, where each keeps its own height: what is a
// rounding error away in plan is not in height.
#include <gtest/gtest.h>

#include "core/arithmetic.hpp"
#include "core/volume.hpp"
#include "support/cells.hpp"
#include "support/merge_judge.hpp"

namespace terrane {
namespace {

using namespace support;

double integral_of_difference(const Tin &a, const Tin &b) {
  double volume = 0;
  for (const Cell &cell : shared_cells(a, b)) volume += cell.volume;
  return volume;
}

double integral(const Tin &tin) {
  double sum = 0;
  for (const Face &f : tin.faces) {
    const Point &p = tin.vertices[f[0]], &q = tin.vertices[f[1]], &r = tin.vertices[f[2]];
    sum += ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x)) / 6 * (p.z + q.z + r.z);
  }
  return sum;
}

std::string wrong_with_merge(std::vector<Tin> tiles, Overlap overlap) {
  for (Tin &tile : tiles) tile = canonical(tile);
  Context context;
  const MergeOptions options{.overlap = overlap, .assembly = {}};
  return broken_promises(tiles, options, merge(tiles, options, context));
}

TEST(cliffs, heights_less_than_a_micrometre_apart_are_two_where_the_surface_is_not_that_steep) {
  const Tin a = canonical(Tin{{{-0.5, -0.049999999999999989, -3},
                               {-0.099999999999999978, 0.35, 2},
                               {0.099999999999999978, 0.15000000000000002, 0}},
                              {{0, 2, 1}}});
  const Tin b = canonical(Tin{{{-0.49999999969999998, -0.050000000500000003, -2},
                               {-0.29999999989999998, 0.14999999970000003, 3},
                               {-0.10000000009999997, 0.34999999989999997, 3},
                               {0.10000000009999997, 0.15000000010000003, 1}},
                              {{0, 2, 1}, {0, 3, 2}}});
  Context context;
  const Volume found = volume(a, b, 0, {}, context);
  EXPECT_NEAR(found.fill.volume - found.cut.volume, integral_of_difference(a, b), 1e-12);
}

TEST(cliffs, a_jump_that_changes_sign_within_rounding_is_closed_on_the_thin_face_alone) {
  const Tin a = canonical(Tin{{{0.031354067201411984, 0.41516871769381425, 140.44997550860859},
                               {0.15623098562933868, 0.26930794927679935, 654.8884935613579},
                               {0.74815469163102621, 0.54445530040715662, 540.73693969828355},
                               {0.91056550901651168, 0.3856661203948446, 363.89817514454046}},
                              {{0, 1, 3}, {0, 3, 2}}});
  const Tin b = canonical(Tin{{{0.328125, 0.12462985598489829, 2},
                               {0.3515625, 0.071031988555248171, 1},
                               {0.28125, 0.23182559084419851, -2},
                               {0.1640625, 0.49981492799244914, -1},
                               {0.0703125, 0.71420639771104966, -1},
                               {0.75696199900535466, 0.85126664198392943, -3}},
                              {{0, 4, 2}, {1, 5, 4}, {2, 4, 3}}});
  Context context;
  EXPECT_NEAR(integral(combine(a, b, -1, Outside::drop, {}, context).tin), integral_of_difference(a, b), 1e-8);
}

TEST(cliffs, where_a_third_tile_reads_a_height_no_cliff_has_changed_it) {
  const Tin a{{{359.375, 430.7367602517055, 276.70162673706318},
               {409.69518144007378, 468.75, 7.98503925003277},
               {309.8098686065108, 632.8125, 312.42469538783598},
               {324.07919901130549, 609.375, 280.84441261507351},
               {453.125, 560.24558675056846, 141.4609564634471}},
              {{0, 1, 3}, {1, 4, 2}}};
  const Tin b{{{375, 525, 186.74243377075578}, {475, 525, 800.12776716914016}, {475, 425, 545.42324637002207}},
              {{0, 2, 1}}};
  const Tin c{{{108.68744942605591, 181.98375269265244, 136.08633555354257},
               {0, 1000, -164.40200702734111},
               {718.16374223781179, 724.17587519017036, -24.214440908754909}},
              {{0, 2, 1}}};
  EXPECT_EQ(wrong_with_merge({a, b, c}, Overlap::min), "");
}

TEST(cliffs, surfaces_that_cross_within_one_keep_their_heights_beside_it) {
  const Tin a{{{500005.33333333331, 4500005.333333333, -11.683225297051255},
               {500008, 4500005.333333333, -1.5219144163871734},
               {500008, 4500002.666666667, -25.007156538793762}},
              {{0, 2, 1}}};
  const Tin b{{{500002.66666666669, 4500008, -58.991205217235894},
               {500005.33333333331, 4500005.333333333, -10.683225297051255},
               {500008, 4500002.666666667, -24.007156538793762},
               {500008, 4500000, -9.2433312224004816}},
              {{0, 1, 2}, {1, 3, 2}}};
  const Tin c{{{500005.33333333331, 4500003.666666667, -191.97153317918878},
               {500005.33333333331, 4500006.333333333, -11.683225297051255},
               {500008, 4500003.666666667, -25.007156538793762}},
              {{0, 2, 1}}};
  EXPECT_EQ(wrong_with_merge({a, b, c}, Overlap::max), "");
}

TEST(cliffs, have_no_height_above_their_own_along_an_edge_that_another_tile_cuts) {
  const Tin a{{{333333.29999999999, 5000000.7000000002, 0},
               {334333.29999999999, 5001000.7000000002, 0},
               {334333.29999999999, 5000000.7000000002, 0}},
              {{0, 2, 1}}};
  const Tin b{{{333708.29999999999, 5000825.7000000002, 0},
               {333990.30453230732, 5000712.7160512498, 0},
               {334408.29999999999, 5000825.7000000002, 0},
               {334189.0364127506, 5000268.8304596581, 0},
               {334319.1101606937, 5000370.1956357369, 0}},
              {{0, 1, 2}, {1, 3, 4}}};
  const Tin cliff{{{334141.89374999999, 5000508.5125000002, 0},
                   {334002.33094730985, 5000843.4518931704, 0},
                   {334062.94034586311, 5000791.7012621136, 2},
                   {334143.75287726749, 5000722.7004207047, 1},
                   {334163.95601011859, 5000705.4502103524, 1}},
                  {{0, 3, 2}, {1, 3, 4}}};
  const Tin d{{{334082.53796306765, 5000721.6866017021, 0},
               {334169.23749999999, 5000742.8875000002, 0},
               {334180.95624999999, 5000707.7312500002, 0}},
              {{0, 2, 1}}};
  const Tin e{{{333768.46479020308, 5000675.2616420519, 0},
               {333839.56734673039, 5000987.1243337644, 0},
               {333458.29999899998, 5001500.6999996249, 0},
               {334458.29999899998, 5001500.7000006251, 0},
               {334431.82417109748, 5001472.9150927607, 0},
               {334348.11993242393, 5000643.104462659, 0}},
              {{0, 5, 1}, {2, 4, 3}}};
  EXPECT_EQ(wrong_with_merge({a, b, cliff, d, e}, Overlap::sum), "");
}

}  // namespace
}  // namespace terrane
