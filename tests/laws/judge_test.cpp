// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/merge.hpp"
#include "core/overlay.hpp"
#include "support/merge_judge.hpp"
#include "support/overlay_judge.hpp"
#include "support/terrains.hpp"

// The judges of the soak and the fuzzers: silent on what is right, and each kind of wrong is seen.
namespace terrane {
namespace {

class OverlayJudge : public ::testing::Test {
 protected:
  void SetUp() override {
    Context context;
    overlaid = overlay(a, b, options, context);
  }
  std::string verdict() const { return support::broken_promises(a, b, options, overlaid); }
  /// A face that lies on both inputs.
  std::size_t shared_face() const {
    std::size_t f = 0;
    while (overlaid.parents[f][0] == none || overlaid.parents[f][1] == none) ++f;
    return f;
  }

  const Tin a = support::with_holes(support::random_terrain(60, 1));
  const Tin b = support::shifted(support::random_terrain(50, 2), 3000, 1000);
  const OverlayOptions options;
  Overlay overlaid;
};

TEST_F(OverlayJudge, IsSilentOnWhatIsRight) { EXPECT_EQ(verdict(), ""); }

TEST_F(OverlayJudge, SeesAVertexThatMoved) {
  overlaid.points[overlaid.faces[shared_face()][0]].x += 1e-6;
  EXPECT_NE(verdict(), "");
}

TEST_F(OverlayJudge, SeesAMissingFace) {
  overlaid.faces.erase(overlaid.faces.begin() + 5);
  overlaid.parents.erase(overlaid.parents.begin() + 5);
  EXPECT_NE(verdict(), "");
}

TEST_F(OverlayJudge, SeesAFaceTwice) {
  overlaid.faces.push_back(overlaid.faces[5]);
  overlaid.parents.push_back(overlaid.parents[5]);
  EXPECT_NE(verdict(), "");
}

TEST_F(OverlayJudge, SeesAFaceThatIsTurnedOver) {
  std::swap(overlaid.faces[5][0], overlaid.faces[5][1]);
  EXPECT_NE(verdict(), "");
}

TEST_F(OverlayJudge, SeesTheWrongParent) {
  auto& parents = overlaid.parents[shared_face()];
  parents[0] = (parents[0] + 1) % static_cast<Index>(a.faces.size());
  EXPECT_NE(verdict(), "");
}

TEST_F(OverlayJudge, SeesAMissingParent) {
  overlaid.parents[shared_face()][1] = none;
  EXPECT_NE(verdict(), "");
}

TEST_F(OverlayJudge, SeesAHeightThatIsOff) {
  overlaid.heights[0][overlaid.faces[shared_face()][1]] += 1e-9;
  EXPECT_NE(verdict(), "");
}

TEST_F(OverlayJudge, SeesAReportOfLessThanWhatMoved) {
  ASSERT_GT(overlaid.rounding.max_move, 0);
  overlaid.rounding.max_move /= 1000;
  EXPECT_NE(verdict(), "");
}

TEST_F(OverlayJudge, SeesAReportOfLessThanWhatSpilt) {
  overlaid.rounding.max_spill = 0;
  EXPECT_NE(verdict(), "");
}

TEST_F(OverlayJudge, SeesAHeightThatIsOffAtACornerOfItsOwnFace) {
  Array<double> corners;
  for (const Face& f : overlaid.faces)
    for (const Index v : f) corners.push_back(overlaid.heights[0][v]);
  overlaid.heights[0] = corners;
  overlaid.per_corner[0] = true;
  ASSERT_EQ(verdict(), "");
  std::size_t c = 0;  // a corner of a face of A that is one of its parent too
  const auto is_own = [&] {
    const Index parent = overlaid.parents[c / 3][0];
    if (parent == none) return false;
    const Point2 p = overlaid.points[overlaid.faces[c / 3][c % 3]];
    return std::any_of(a.faces[parent].begin(), a.faces[parent].end(),
                       [&](Index v) { return plan(a.vertices[v]) == p; });
  };
  while (!is_own()) ++c;
  overlaid.heights[0][c] = std::nextafter(overlaid.heights[0][c], 1e9);
  EXPECT_NE(verdict(), "");
}

TEST_F(OverlayJudge, SeesRegionsThatAreNotCounted) {
  overlaid.rounding.regions = 10;
  EXPECT_NE(verdict(), "");
}

class MergeJudge : public ::testing::Test {
 protected:
  void SetUp() override {
    Context context;
    merged = merge(tiles, options, context);
  }
  std::string verdict() const { return support::broken_promises(tiles, options, merged); }

  const std::vector<Tin> tiles{support::random_terrain(40, 1),
                               support::shifted(support::random_terrain(40, 2), 8000, 0),
                               support::shifted(support::with_holes(support::random_terrain(40, 3)), 2000, 5000)};
  const MergeOptions options{Overlap::mean, {}};
  Merged merged;
};

TEST_F(MergeJudge, IsSilentOnWhatIsRight) { EXPECT_EQ(verdict(), ""); }

TEST_F(MergeJudge, SeesAMissingFace) {
  merged.surface.tin.faces.erase(merged.surface.tin.faces.begin() + 7);
  EXPECT_NE(verdict(), "");
}

TEST_F(MergeJudge, SeesAMissingWall) {
  auto& tin = merged.surface.tin;
  const auto wall = std::find_if(tin.faces.begin(), tin.faces.end(), [&](const Face& f) { return is_wall(tin, f); });
  ASSERT_NE(wall, tin.faces.end());
  tin.faces.erase(wall);
  EXPECT_NE(verdict(), "");
}

TEST_F(MergeJudge, SeesAHeightThatIsOff) {
  merged.surface.tin.vertices[9].z += 1e-3;
  EXPECT_NE(verdict(), "");
}

TEST_F(MergeJudge, SeesAnAreaThatIsOff) {
  merged.surface.tin.vertices[0].x -= 1e-3;
  EXPECT_NE(verdict(), "");
}

}  // namespace
}  // namespace terrane
