// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/union_area.hpp"

#include <gtest/gtest.h>

#include "ops/heights.hpp"

using namespace terrane;

namespace {

Tin rectangle(double xmin, double ymin, double xmax, double ymax) {
  return {{{xmin, ymin, 0}, {xmax, ymin, 0}, {xmax, ymax, 0}, {xmin, ymax, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

double area_of(std::vector<Tin> tiles) {
  Context context;
  std::vector<const Tin*> pointers;
  for (const Tin& tin : tiles) pointers.push_back(&tin);
  return union_area(height_fields(pointers, context), context).value();
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

// The corners of the second lie on the sides of the first, but for rounding: an ulp inside, outside or on them.
TEST(UnionArea, BordersAnUlpApartCountOnce) {
  const Point a{0.1, 0.2, 0}, b{10.3, 3.7, 0}, c{2.9, 11.1, 0};
  const Tin triangle{{a, b, c}, {{0, 1, 2}}};
  Tin fan{{{(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, 0}}, {}};
  const auto side = [&](Point p, Point q) {
    for (int k = 0; k < 5; ++k) fan.vertices.push_back({p.x + k * (q.x - p.x) / 5, p.y + k * (q.y - p.y) / 5, 0});
  };
  side(a, b), side(b, c), side(c, a);
  for (Index k = 0; k < 15; ++k) fan.faces.push_back({0, k + 1, (k + 1) % 15 + 1});
  const double whole = area_of({triangle});
  EXPECT_NEAR(area_of({triangle, fan}), whole, 1e-11);
  EXPECT_NEAR(area_of({fan, triangle}), whole, 1e-11);
  Tin part = fan;
  part.faces.resize(5);  // beside the rest of the fan, inside the triangle
  Tin rest = fan;
  rest.faces.erase(rest.faces.begin(), rest.faces.begin() + 5);
  EXPECT_NEAR(area_of({part, triangle, rest}), whole, 1e-11);
}
