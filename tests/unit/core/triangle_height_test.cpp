// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/triangle_height.hpp"

#include <gtest/gtest.h>

#include "support/height_judge.hpp"

namespace terrane {
namespace {

void expect_right(const Point& a, const Point& b, const Point& c, Point2 p) {
  const Tin tin{{a, b, c}, {{0, 1, 2}}};
  const double z = height_on_triangle({plan(a), plan(b), plan(c)}, {a.z, b.z, c.z}, p);
  EXPECT_TRUE(support::HeightJudge(tin).allows(p, 0, z, 0)) << z << " at " << p.x << " " << p.y;
}

TEST(TriangleHeight, IsRightToAFewUlpsOnAThinTriangleAskewInItsBox) {
  expect_right({-4845.9206929038919, -1953.125, 4.9078623619384381},
               {-2763.1402518486416, 4453.125, 0.1106667724909407},
               {-4383.6827716155676, -312.5, 2.9677415748216784}, {-4354.0252968511058, -311.19671847035499});
  expect_right({500776.99691657437, 4506549.4801312657, -19.383703191894309},
               {505453.52905587043, 4504808.3640748989, 34.346082426534764},
               {506961.58253515011, 4504299.2602565549, 51.463032492707477}, {503916.51877579372, 4505401.3853782816});
  expect_right({-497.18872689347506, 197.0531412636642, 68.057440822894549},
               {0, 250, -5.8922086658820039},
               {-497.64394173878679, 201.51796981681775, 65.768884689055838},
               {-97.288849632073493, 240.02249177698735});
  expect_right({500000, 4500000, 676.82726718021377}, {500639.85894186294, 4500774.0799073251, 825.53466539794533},
               {500639.23074616474, 4500797.557981045, 169.42699759285773}, {500194.26909961429, 4500236.8886354472});
}

TEST(TriangleHeight, IsRightOnTheThinnestTriangleThereIs) {
  // Twice its area is an ulp times an ulp.
  constexpr double ulp = 0x1p-40;
  expect_right({4096, 4096, 0}, {8191 + ulp, 8191 - ulp, 100}, {8192, 8192, -50}, {5000, 5000});
  expect_right({4096, 4096, 0}, {8192, 8192, -50}, {6144, 6144 + ulp, 100}, {6143.5, 6143.5});
}

}  // namespace
}  // namespace terrane
