// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay/depth.hpp"

#include <gtest/gtest.h>

#include <array>

#include "core/box.hpp"

namespace terrane {
namespace {

class depth : public testing::Test {
 protected:
  double of(std::array<Point2, 3> face) { return Depth(mesh_, 16, 1).of(face); }
  double at(Point2 p) { return Depth(mesh_, 16, 1).of({&p, 1}); }

  const Tin needle_{{{0, 0, 0}, {100, 0, 0}, {100, 5, 0}}, {{0, 1, 2}}};
  const CompletedMesh mesh_ = complete(needle_, frame_around(bounds(needle_)));
};

TEST_F(depth, is_the_distance_to_the_nearest_place_outside) {
  EXPECT_EQ(at({50, -1}), 0);
  EXPECT_EQ(at({50, 0}), 0);
  EXPECT_NEAR(at({90, 0.5}), 0.5, 1e-12);
}

TEST_F(depth, of_an_edge_is_more_than_that_of_its_ends_where_the_mesh_stands_between_them) {
  const Point2 tip{0, 0}, beyond{100.5, 1.7}, beside{100.5, -10};
  EXPECT_EQ(at(tip), 0);
  EXPECT_EQ(at(beyond), 0);
  EXPECT_GT(of({tip, beside, beyond}), 1);
  EXPECT_LE(of({tip, beside, beyond}), 1.7);
}

TEST_F(depth, of_edges_along_one_border_is_none) {
  EXPECT_EQ(of({Point2{10, 0}, {50, -30}, {90, 0}}), 0);
  EXPECT_EQ(of({Point2{0, 0}, {50, -30}, {100, 0}}), 0);
}

}  // namespace
}  // namespace terrane
