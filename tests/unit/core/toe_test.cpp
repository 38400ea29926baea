// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/toe.hpp"

#include <gtest/gtest.h>

#include "core/validate.hpp"
#include "core/volume.hpp"

namespace terrane {
namespace {

/// A 4 x 4 lattice of heights, without the middle cell when `hole`.
Tin lattice(bool hole) {
  Tin tin;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      const bool inner = i % 3 != 0 && j % 3 != 0;
      tin.vertices.push_back({1.0 * i, 1.0 * j, inner ? 5.0 : i + j});
    }
  for (Index j = 0; j < 3; ++j)
    for (Index i = 0; i < 3; ++i) {
      if (hole && i == 1 && j == 1) continue;
      const Index v = 4 * j + i;
      tin.faces.push_back({v, v + 1, v + 5});
      tin.faces.push_back({v, v + 5, v + 4});
    }
  return canonical(tin);
}

TEST(Toe, IsThePlaneThroughABorderThatIsFlat) {
  Context context;
  const Tin pile = lattice(false), toe = toe_surface(pile, context);
  EXPECT_EQ(toe.vertices.size(), 12u);
  EXPECT_DOUBLE_EQ(plan_area(toe), 9);
  for (const Point& p : toe.vertices) EXPECT_EQ(p.z, p.x + p.y);
  EXPECT_EQ(checked(toe, "toe", context), toe);
}

TEST(Toe, FollowsTheBorderOfHoles) {
  Context context;
  const Tin toe = toe_surface(lattice(true), context);
  EXPECT_EQ(toe.vertices.size(), 16u);
  EXPECT_DOUBLE_EQ(plan_area(toe), 8);
}

TEST(Toe, StandsAtTheFootOfWalls) {
  // A step along x = 1: its border has two heights at (1, 0) and (1, 1).
  const Tin step = canonical({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 3}, {2, 0, 3}, {2, 1, 3}, {1, 1, 3}},
                              {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}, {1, 4, 2}, {4, 7, 2}}});
  Context context;
  for (const Point& p : toe_surface(step, context).vertices) EXPECT_EQ(p.z, p.x == 2 ? 3 : 0);
}

}  // namespace
}  // namespace terrane
