// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/validate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/error.hpp"
#include "core/volume.hpp"

namespace terrane {
namespace {

//  3---2
//  | / |
//  0---1
Tin square(double x = 0, double y = 0, double size = 1, double z = 0) {
  return {{{x, y, z}, {x + size, y, z}, {x + size, y + size, z}, {x, y + size, z}}, {{0, 1, 2}, {0, 2, 3}}};
}

Tin& append(Tin& tin, const Tin& more) {
  const auto shift = static_cast<Index>(tin.vertices.size());
  tin.vertices.insert(tin.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const Face& f : more.faces) tin.faces.push_back({f[0] + shift, f[1] + shift, f[2] + shift});
  return tin;
}

std::size_t count(const std::vector<Defect>& defects, const std::string& code) {
  return std::count_if(defects.begin(), defects.end(), [&](const Defect& d) { return d.code == code; });
}

std::string refusal(const Tin& tin) {
  Context context;
  try {
    checked(tin, "in.ply", context);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::input);
    EXPECT_NE(std::string(error.what()).find("in.ply"), std::string::npos) << error.what();
    return error.code;
  }
  return "";
}

TEST(FindDefects, ValidTinHasNone) {
  EXPECT_TRUE(find_defects(square()).empty());
  EXPECT_TRUE(find_defects(Tin{}).empty());
}

TEST(FindDefects, NamesTheVertexThatIsNotFinite) {
  for (const double bad : {NAN, INFINITY, -INFINITY}) {
    Tin tin = square();
    tin.vertices[2].z = bad;
    const auto defects = find_defects(tin);
    ASSERT_EQ(defects.size(), 1u);
    EXPECT_EQ(defects[0].code, "not-finite");
    EXPECT_EQ(defects[0].element, "vertex 2");
    EXPECT_EQ(refusal(tin), "not-finite");
  }
}

TEST(FindDefects, NamesTheFaceWhoseIndexIsOutOfRange) {
  for (const Index bad : {4, -1, std::numeric_limits<Index>::max(), std::numeric_limits<Index>::min()}) {
    Tin tin = square();
    tin.faces[1][2] = bad;
    const auto defects = find_defects(tin);
    ASSERT_EQ(defects.size(), 1u);
    EXPECT_EQ(defects[0].code, "index-out-of-range");
    EXPECT_EQ(defects[0].element, "face 1");
    EXPECT_EQ(refusal(tin), "index-out-of-range");
  }
}

TEST(FindDefects, CrossingBordersAreOverlaps) {
  Tin tin = square();
  append(tin, square(0.5, 0.25));
  const auto defects = find_defects(tin);
  ASSERT_GT(count(defects, "overlapping-faces"), 0u);
  EXPECT_EQ(defects[0].element, "faces 0 and 2");
  EXPECT_EQ(refusal(tin), "overlapping-faces");
}

TEST(FindDefects, AFaceInsideAnotherIsAnOverlap) {
  Tin tin = square(0, 0, 8);
  append(tin, {{{5, 1, 0}, {6, 1, 0}, {6, 2, 0}}, {{0, 1, 2}}});
  const auto defects = find_defects(tin);
  ASSERT_EQ(count(defects, "overlapping-faces"), 1u);
  EXPECT_EQ(defects[0].element, "faces 0 and 2");
}

TEST(FindDefects, TheSameTriangleAtTwoHeightsIsRefused) {
  Tin tin = square();
  append(tin, square(0, 0, 1, 5));
  EXPECT_GT(count(find_defects(tin), "overlapping-faces"), 0u);
  EXPECT_GT(count(find_defects(tin), "non-manifold-edge"), 0u);
}

// A crack of one ulp between neighbours is no overlap, an overlap of one ulp is one: judged exactly, far from the
// origin.
TEST(FindDefects, OneUlpDecides) {
  const double x = 500000, y = 4500000;
  for (const int side : {-1, 1}) {
    Tin tin = square(x, y);
    append(tin, square(std::nextafter(x + 1, side * INFINITY), y));
    EXPECT_EQ(count(find_defects(tin), "overlapping-faces") > 0, side < 0);
  }
}

TEST(FindDefects, AnEdgeWithThreeFaces) {
  Tin tin = square();
  tin.vertices.push_back({2, 0.5, 0});
  tin.faces.push_back({1, 4, 2});
  EXPECT_TRUE(find_defects(tin).empty());
  tin.vertices.push_back({3, 0.75, 0});
  tin.faces.push_back({1, 5, 2});
  const auto defects = find_defects(tin);
  ASSERT_EQ(count(defects, "non-manifold-edge"), 1u);
  EXPECT_EQ(defects[0].element, "edge 1-2");
  EXPECT_NE(defects[0].message.find("0, 2, 3"), std::string::npos) << defects[0].message;
}

TEST(FindDefects, LimitHoldsPerCode) {
  Tin tin = square();
  for (int i = 0; i < 100; ++i) tin.vertices.push_back({5.0 + i, 5, 0}), tin.faces.push_back({0, 0, 1});
  const auto defects = find_defects(tin, 7);
  EXPECT_EQ(count(defects, "unused-vertex"), 7u);
  EXPECT_EQ(count(defects, "zero-area-face"), 7u);
}

// Two tiles that share an edge in plan, at different heights.
TEST(FindDefects, AnOpenJumpAlongAnEdgeIsLegal) {
  Tin tin = square(0, 0, 1, 0);
  append(tin, square(1, 0, 1, 3));
  EXPECT_TRUE(find_defects(tin).empty());
}

TEST(FindDefects, AWallIsLegal) {
  Tin tin = square(0, 0, 1, 0);
  append(tin, square(1, 0, 1, 3));
  tin.faces.push_back({1, 4, 2});
  tin.faces.push_back({4, 7, 2});
  EXPECT_TRUE(find_defects(tin).empty());
  EXPECT_EQ(inspect(tin).walls, 2u);
}

TEST(FindDefects, PlacesAreWrittenAsPeopleWriteThem) {
  Tin tin = square(500000, 0.1);
  tin.vertices.push_back(tin.vertices[0]);
  tin.faces[1][0] = 4;
  const auto defects = find_defects(tin);
  ASSERT_EQ(defects.size(), 1u);
  EXPECT_EQ(defects[0].message, "are the same point (500000, 0.1)");
}

// Two squares that meet in one corner only, as merge and threshold return them: no line, so no jump and no wall.
TEST(FindDefects, TwoHeightsAtAPinchAreLegal) {
  Tin tin = square(0, 0, 1, 0);
  append(tin, square(1, 1, 1, 2));
  EXPECT_TRUE(find_defects(tin).empty());
  append(tin, {{{1, 0, 0}, {2, 0, 0}, {2, 1, 2}, {1, 1, 1}}, {{0, 1, 2}, {0, 2, 3}}});
  EXPECT_EQ(count(find_defects(tin), "two-heights"), 2u);  // joins both by edges that agree at their other ends
  EXPECT_EQ(refusal(tin), "two-heights");
}

// A square around a centre that is there twice: two heights at one point, and no line along which the surface jumps.
TEST(FindDefects, TwoHeightsInTheMiddle) {
  Tin tin{{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 1}, {1, 1, 2}},
          {{0, 1, 4}, {1, 2, 4}, {2, 3, 5}, {3, 0, 5}}};
  EXPECT_EQ(refusal(tin), "two-heights");
  tin.vertices.push_back({2, 2, 3});  // the jump runs on to the border: open, but a line
  tin.faces[2] = {6, 3, 5};
  EXPECT_TRUE(find_defects(tin).empty());
}

TEST(FindDefects, CoordinatesThatOverflow) {
  Tin tin = square();
  tin.vertices[1].x = 1e200;
  EXPECT_EQ(refusal(tin), "too-large");
}

TEST(Checked, MendsWhatIsHarmlessAndSaysSo) {
  Tin tin = square();
  tin.vertices.push_back({0, 0, 0});                 // 4 is 0 again
  tin.vertices.push_back({9, 9, 9});                 // 5 is unused
  tin.faces = {
      {0, 1, 2}, {4, 3, 2}, {2, 0, 1}, {1, 1, 2}};  // the second is clockwise, the third the first, the fourth flat
  Context context;
  Mending mending;
  const Tin mended = checked(tin, "in.ply", context, &mending);
  EXPECT_EQ(mended, canonical(square()));
  EXPECT_EQ(mending.duplicate_vertices, 1u);
  EXPECT_EQ(mending.unused_vertices, 1u);
  EXPECT_EQ(mending.clockwise_faces, 1u);
  EXPECT_EQ(mending.duplicate_faces, 1u);
  EXPECT_EQ(mending.zero_area_faces, 1u);
  EXPECT_EQ(mending.t_junctions, 0u);
  ASSERT_EQ(context.warnings.size(), 5u);
  for (const Warning& warning : context.warnings) {
    EXPECT_EQ(warning.code, "mended");
    EXPECT_EQ(warning.input, "in.ply");
  }
}

TEST(Checked, IsTheSameForAnyOrder) {
  Tin tin = square(0, 0, 1, 0);
  append(tin, square(1, 0, 1, 3));
  append(tin, square(2, 0, 1, 3));
  Context context;
  const Tin expected = checked(tin, "", context);
  std::mt19937 random(7);
  for (int run = 0; run < 20; ++run) {
    std::vector<Index> to(tin.vertices.size());
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = static_cast<Index>(i);
    std::shuffle(to.begin(), to.end(), random);
    Tin shuffled = tin;
    for (std::size_t i = 0; i < to.size(); ++i) shuffled.vertices[to[i]] = tin.vertices[i];
    for (Face& face : shuffled.faces) face = {to[face[1]], to[face[2]], to[face[0]]};
    std::shuffle(shuffled.faces.begin(), shuffled.faces.end(), random);
    EXPECT_EQ(checked(shuffled, "", context), expected);
  }
}

//  3-------2---7      the big square's right edge carries the vertices 4 and 5 of the small ones
//  |       4---6
//  |       5
//  0-------1
TEST(Checked, SplitsFacesAtTJunctionsWithoutMovingTheSurface) {
  Tin tin = square(0, 0, 4);
  tin.vertices[2].z = 4;  // heights along the right edge: z = y
  tin.vertices.insert(tin.vertices.end(), {{4, 3, 3}, {4, 1, 1}, {6, 3, 0}, {6, 4, 0}});
  tin.faces.insert(tin.faces.end(), {{4, 6, 7}, {4, 7, 2}, {5, 6, 4}});
  ASSERT_EQ(inspect(tin).t_junctions, 2u);
  const auto defects = find_defects(tin);
  ASSERT_EQ(defects.size(), 2u);
  EXPECT_EQ(defects[0].code, "t-junction");
  EXPECT_EQ(defects[0].element, "vertex 5");
  EXPECT_EQ(defects[1].element, "vertex 4");

  Context context;
  Mending mending;
  const Tin mended = checked(tin, "in.ply", context, &mending);
  EXPECT_EQ(mending.t_junctions, 2u);
  EXPECT_EQ(mended.vertices.size(), 8u);
  EXPECT_EQ(mended.faces.size(), 7u);
  EXPECT_NE(std::find(mended.vertices.begin(), mended.vertices.end(), Point{4, 1, 1}), mended.vertices.end());
  const Inspection before = inspect(tin), after = inspect(mended);
  EXPECT_EQ(after.t_junctions, 0u);
  EXPECT_EQ(after.inverted + after.degenerate + after.overlaps + after.non_manifold_edges, 0u);
  EXPECT_EQ(plan_area(mended), plan_area(tin));
  EXPECT_EQ(before.components, 2u);
  EXPECT_EQ(after.components, 1u);
  Context again;
  EXPECT_EQ(checked(mended, "", again), mended);
  EXPECT_TRUE(again.warnings.empty());
  tin.vertices[5].z = 7;  // off the edge by six: a crack, which splitting the face would only make permanent
  EXPECT_EQ(refusal(tin), "two-heights");
}

// A triangle touched on all three sides, several times each, in both orientations.
TEST(Checked, SplitsAFaceTouchedOnEverySide) {
  for (const bool clockwise : {false, true}) {
    Tin tin{{{0, 0, 0}, {8, 0, 8}, {0, 8, 16}}, {{0, 1, 2}}};
    if (clockwise) std::swap(tin.faces[0][0], tin.faces[0][1]);
    append(tin, {{{2, 0, 2}, {3, -1, 0}, {5, 0, 5}}, {{0, 1, 2}}});
    append(tin, {{{6, 2, 10}, {7, 3, 0}, {4, 4, 12}}, {{0, 1, 2}}});
    append(tin, {{{0, 6, 12}, {-1, 5, 0}, {0, 1, 2}}, {{0, 1, 2}}});
    Context context;
    Mending mending;
    const Tin mended = checked(tin, "", context, &mending);
    EXPECT_EQ(mending.t_junctions, 6u);
    EXPECT_EQ(mended.faces.size(), 1 + 6 + 3u);
    EXPECT_EQ(mended.vertices.size(), 12u);
    const Inspection after = inspect(mended);
    EXPECT_EQ(after.t_junctions + after.inverted + after.degenerate + after.overlaps, 0u);
    EXPECT_EQ(after.components, 1u);
    EXPECT_EQ(plan_area(mended), 38);
  }
}

TEST(Checked, KeepsWalls) {
  Tin tin = square(0, 0, 1, 0);
  append(tin, square(1, 0, 1, 3));
  tin.faces.push_back({1, 4, 2});
  tin.faces.push_back({4, 7, 2});
  Context context;
  EXPECT_EQ(inspect(checked(tin, "", context)).walls, 2u);
  EXPECT_TRUE(context.warnings.empty());
}

}  // namespace
}  // namespace terrane
