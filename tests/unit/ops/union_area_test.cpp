// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/union_area.hpp"

#include <gtest/gtest.h>

using namespace terrane;

namespace {

Tin rectangle(double xmin, double ymin, double xmax, double ymax) {
  return {{{xmin, ymin, 0}, {xmax, ymin, 0}, {xmax, ymax, 0}, {xmin, ymax, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

double area_of(std::vector<Tin> tiles) {
  Context context;
  std::vector<const Tin*> pointers;
  for (const Tin& tin : tiles) pointers.push_back(&tin);
  return union_area(pointers, context);
}

}  // namespace

TEST(UnionArea, ThreeTilesOverOnePlaceCountOnce) {
  EXPECT_DOUBLE_EQ(area_of({rectangle(0, 0, 4, 4), rectangle(2, 2, 6, 6), rectangle(1, 1, 5, 5)}),
                   16 + 16 + 16 - 9 - 9 - 4 + 4);
}

TEST(UnionArea, SharedBordersCancelAndCopiesCountOnce) {
  EXPECT_DOUBLE_EQ(area_of({rectangle(0, 0, 1, 1), rectangle(1, 0, 2, 1), rectangle(1, 0.5, 3, 1)}), 2.5);
  EXPECT_DOUBLE_EQ(area_of({rectangle(0, 0, 1, 1), rectangle(0, 0, 1, 1), rectangle(0, 0, 1, 1)}), 1);
}

TEST(UnionArea, IslandsInsideAndApart) {
  EXPECT_DOUBLE_EQ(area_of({rectangle(0, 0, 10, 10), rectangle(2, 2, 3, 3), rectangle(20, 0, 21, 1)}), 101);
  EXPECT_DOUBLE_EQ(area_of({Tin{}, rectangle(0, 0, 2, 2)}), 4);
}
