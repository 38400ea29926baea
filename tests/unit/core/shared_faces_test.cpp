// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay/shared_faces.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/overlay_judge.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using namespace support;

Overlay overlaid(const Tin& a, const Tin& b) {
  Context context;
  return overlay(a, b, {}, context);
}

/// Without faces around one place well inside the square.
Tin with_hole(const Tin& tin, double x, double y, double radius) {
  return without(tin, [&](Point2 c) { return std::hypot(c.x - x * side, c.y - y * side) < radius * side; });
}

TEST(shared_faces, identical_surfaces_come_back_as_they_are) {
  const Tin a = canonical(random_terrain(200, 1)), b = shifted(a, 0, 0, 5);
  const Overlay o = overlaid(a, b);
  EXPECT_EQ(o.faces.size(), a.faces.size());
  EXPECT_EQ(o.points.size(), a.vertices.size());
  EXPECT_EQ(static_cast<std::size_t>(o.rounding.regions), a.faces.size());
  for (Index f = 0; f < static_cast<Index>(o.faces.size()); ++f)
    for (int k = 0; k < 3; ++k) EXPECT_EQ(o.height(1, f, k), o.height(0, f, k) + 5);
  EXPECT_EQ(broken_promises(a, b, {}, o), "");
}

TEST(shared_faces, what_changed_is_overlaid_and_the_rest_is_set_aside) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const Tin t = canonical(random_terrain(250, seed)), moved = canonical(edited(t, 30, seed));
    const std::vector<std::array<Tin, 2>> pairs = {{t, moved},
                                                   {moved, t},
                                                   {with_hole(t, 0.3, 0.6, 0.15), t},
                                                   {with_hole(t, 0.5, 0.5, 0.1), moved},
                                                   {with_hole(t, 0.3, 0.6, 0.15), with_hole(moved, 0.7, 0.3, 0.1)}};
    for (const auto& [a, b] : pairs) {
      const auto divided = divide(a, b);
      const bool one_holds_the_other = &a == &pairs[2][0];
      ASSERT_EQ(divided.has_value(), !one_holds_the_other);
      if (divided) {
        EXPECT_GT(divided->shared.size(), a.faces.size() / 2);
        EXPECT_EQ(divided->rest[0].faces.size() + divided->shared.size(), a.faces.size());
        EXPECT_EQ(divided->rest[1].faces.size() + divided->shared.size(), b.faces.size());
      }
      EXPECT_EQ(broken_promises(a, b, {}, overlaid(a, b)), "");
    }
  }
}

TEST(shared_faces, surfaces_with_little_in_common_or_two_heights_at_a_place_are_left_whole) {
  const Tin t = canonical(random_terrain(250, 1));
  EXPECT_FALSE(divide(t, canonical(random_terrain(250, 2))));
  EXPECT_FALSE(divide(t, canonical(shifted(t, 1, 0))));
  EXPECT_FALSE(divide(t, Tin{}));
  const Tin torn =
      canonical(Tin{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}, {{0, 1, 2}, {3, 5, 4}}});
  EXPECT_FALSE(divide(torn, torn));
}

/// With two vertices that follow each other changed over: no longer in canonical order, but nearly.
Tin changed_over(Tin tin, Index v) {
  std::swap(tin.vertices[v], tin.vertices[v + 1]);
  for (Face& f : tin.faces)
    for (Index& corner : f) corner = corner == v ? v + 1 : corner == v + 1 ? v : corner;
  return tin;
}

TEST(shared_faces, surfaces_in_no_canonical_order_are_overlaid_right) {
  const Tin t = canonical(random_terrain(150, 1)), a = with_hole(t, 0.2, 0.8, 0.15), b = canonical(edited(t, 300, 2));
  for (Index v = 0; v + 1 < static_cast<Index>(b.vertices.size()); ++v) {
    SCOPED_TRACE(v);
    const Tin disordered = changed_over(b, v);
    EXPECT_EQ(broken_promises(a, disordered, {}, overlaid(a, disordered)), "");
  }
}

}  // namespace
}  // namespace terrane
