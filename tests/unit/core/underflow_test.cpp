// SPDX-License-Identifier: GPL-3.0-or-later
// Coordinates 300 orders of magnitude below the others, where products and
// areas have few digits or none.
#include <gtest/gtest.h>

#include "core/predicates.hpp"
#include "core/triangle_height.hpp"
#include "support/overlay_judge.hpp"

namespace terrane {
namespace {

constexpr double tiny = 4.9406564584124654e-324;

std::string wrong_with_overlay(const Tin &a, const Tin &b, double snap) {
  Context context;
  const OverlayOptions options{.snap = snap};
  return support::broken_promises(a, b, options, overlay(a, b, options, context));
}

TEST(underflow, an_orientation_is_exact) {
  // The products round to 1 and 2 of the smallest doubles, on the wrong sides
  // of each other.
  EXPECT_EQ(orientation({-2.577279161666298e-16, 0}, {2.0999999999999996, tiny}, {10.5, 5 * tiny}), -1);
  EXPECT_EQ(orientation({1.3004306604878597e-16, 0}, {7.5, 7 * tiny}, {1.0714285714285716, tiny}), -1);
}

TEST(underflow, a_height_is_interpolated_in_a_triangle_of_the_smallest_width) {
  EXPECT_DOUBLE_EQ(height_on_triangle({{0, 0}, {5 * tiny, 0}, {0, 1}}, {1, 6, 1}, {2 * tiny, 0.25}), 3);
}

TEST(underflow, the_distance_from_a_segment_of_no_length_is_a_number) {
  double distance;
  EXPECT_EQ(nearest_on_segment({0, 0}, {tiny, 0}, {3, 4}, distance), 0);
  EXPECT_NEAR(distance, 5, 1e-11);
}

TEST(underflow, edges_the_smallest_double_apart_cross_where_they_do) {
  const Tin a = canonical(Tin{{{tiny, -0.25, 51}, {-2 * tiny, 0.25, 31}, {0.5, -0.25, 101}}, {{0, 2, 1}}});
  const Tin b = canonical(Tin{{{0, -0.25, 50}, {0, 0.25, 30}, {0.5, -0.25, 100}}, {{0, 2, 1}}});
  EXPECT_EQ(wrong_with_overlay(a, b, 0), "");
  EXPECT_EQ(wrong_with_overlay(b, a, 0), "");
}

TEST(underflow, crossings_of_edges_the_smallest_double_apart_stand_in_their_order) {
  const Tin a = canonical(Tin{{{2 * tiny, 4.0000000000000018, -13},
                               {-1.4041992782053154, 2.3282852631369346, -42},
                               {tiny, 4.9903172802953453, -4},
                               {0, 6.1099660246824978, -28},
                               {-1.0034267831477821, 6.6392651298570655, -42},
                               {-tiny, 6.9496614077138492, -29},
                               {0.45482271906644367, 7.0903545618671142, -32},
                               {-2 * tiny, 8.0000000000000018, -42}},
                              {{1, 0, 2}, {4, 3, 5}, {5, 6, 7}}});
  const Tin b = canonical(Tin{{{4, 0, 50}, {0, 8, -39}, {0, 4, -19}}, {{0, 1, 2}}});
  EXPECT_EQ(wrong_with_overlay(a, b, -1), "");
  EXPECT_EQ(wrong_with_overlay(b, a, -1), "");
}

TEST(underflow, a_vertex_may_go_with_a_tip_of_the_smallest_width) {
  const Tin a = canonical(Tin{{{0, 1, 0}, {0.23268946045718097, 1.125, 1}, {4, 5.7208882576032769, 0}}, {{0, 1, 2}}});
  const Tin b = canonical(
      Tin{{{2 * tiny, 1, 0}, {0.23268946045718095, 1.1249999999999996, 1}, {4, 5.7208882576032778, 0}}, {{0, 1, 2}}});
  EXPECT_EQ(wrong_with_overlay(a, b, 0), "");
  EXPECT_EQ(wrong_with_overlay(b, a, 0), "");
}

}  // namespace
}  // namespace terrane
