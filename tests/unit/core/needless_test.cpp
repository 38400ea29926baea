// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge/needless.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/merge.hpp"
#include "support/merge_judge.hpp"

namespace terrane {
namespace {

/// Squares of two faces, each a little beside the one before: all lines of one direction lie close together.
std::vector<Tin> pile(int count) {
  std::vector<Tin> tiles;
  for (int i = 0; i < count; ++i) {
    const double x = 0.01 * i, y = 0.003 * i;
    Tin tin;
    tin.vertices = {{x, y, 0.1 * i}, {x + 1, y, 1}, {x + 1, y + 1, 2 + 0.01 * i}, {x, y + 1, 0.5}};
    tin.faces = {{0, 1, 2}, {0, 2, 3}};
    tiles.push_back(canonical(tin));
  }
  return tiles;
}

Merged merged(const std::vector<Tin>& tiles, const MergeOptions& options) {
  Context context;
  return merge(tiles, options, context);
}

class Pile : public testing::TestWithParam<std::pair<Overlap, Seam>> {};

/// As many lines as there are tiles cross as many others: faces are as their square. They were as 1.5 to the power of
/// their number.
TEST_P(Pile, GrowsWithTheCrossings) {
  const auto [overlap, seam] = GetParam();
  MergeOptions options;
  options.overlap = overlap;
  options.assembly.seam = seam;
  for (const int count : {5, 10, 20}) {
    const std::vector<Tin> tiles = pile(count);
    const Merged result = merged(tiles, options);
    EXPECT_LT(result.surface.tin.faces.size(), 100u * count * count);
    if (seam != Seam::ramp && count < 20) {
      EXPECT_EQ(support::broken_promises(tiles, options, result), "");
    }
    std::vector<Tin> reversed(tiles.rbegin(), tiles.rend());
    EXPECT_EQ(merged(reversed, options).surface.tin, result.surface.tin);
  }
}

INSTANTIATE_TEST_SUITE_P(EveryPolicy, Pile,
                         testing::Values(std::pair(Overlap::mean, Seam::wall), std::pair(Overlap::sum, Seam::wall),
                                         std::pair(Overlap::min, Seam::wall), std::pair(Overlap::max, Seam::wall),
                                         std::pair(Overlap::median, Seam::wall), std::pair(Overlap::mean, Seam::split),
                                         std::pair(Overlap::mean, Seam::ramp)));

Piece piece(Array<Point2> points, std::vector<Face> faces, std::vector<Index> cells) {
  Piece made;
  made.surface.points = std::move(points);
  for (const Face& f : faces) made.surface.faces.push_back(f);
  made.surface.z.assign(3 * faces.size(), 0);
  made.surface.firm.assign(3 * faces.size(), 0);
  made.contributors.assign(faces.size(), 0);
  made.cells = std::move(cells);
  return made;
}

const Array<Point2> square{{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 1}};
const std::vector<Face> quarters{{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};

Piece without_middle(const std::vector<Index>& cells, double tolerance = 0) {
  const Array<Point2> corners{{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  const Piece near = piece(corners, {{0, 1, 2}, {0, 2, 3}}, {0, 0}), tile = piece(corners, {{0, 1, 2}}, {1});
  return without_needless(piece(square, quarters, cells), near, tile, tolerance);
}

TEST(Needless, VertexInsideOneCellGoes) { EXPECT_EQ(without_middle({7, 7, 7, 7}).surface.faces.size(), 2u); }

TEST(Needless, VertexOnTheLineBetweenTwoCellsGoesAndTheLineStays) {
  const Piece left = without_middle({7, 7, 8, 8});
  ASSERT_EQ(left.surface.faces.size(), 2u);
  for (std::size_t f = 0; f < 2; ++f) {
    const Face& face = left.surface.faces[f];
    const bool below = std::find(face.begin(), face.end(), 1) != face.end();
    EXPECT_EQ(left.cells[f], below ? 7 : 8);
  }
}

TEST(Needless, VertexWhereTheLineBendsStays) { EXPECT_EQ(without_middle({7, 7, 7, 8}).surface.faces.size(), 4u); }

TEST(Needless, VertexWhereThreeCellsMeetStays) { EXPECT_EQ(without_middle({7, 7, 8, 9}).surface.faces.size(), 4u); }

TEST(Needless, VertexThatATileBroughtStays) {
  const Piece near = piece(square, quarters, {0, 0, 0, 0}), tile = piece(square, {{0, 1, 4}}, {1});
  EXPECT_EQ(without_needless(piece(square, quarters, {7, 7, 7, 7}), near, tile, 0).surface.faces.size(), 4u);
}

TEST(Needless, LineMaySwayByTheToleranceAndNoMore) {
  const Array<Point2> corners{{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  const Piece near = piece(corners, {{0, 1, 2}, {0, 2, 3}}, {0, 0}), tile = piece(corners, {{0, 1, 2}}, {1});
  Array<Point2> swayed = square;
  swayed[4].x += 1e-9;
  const auto faces_at = [&](double tolerance) {
    return without_needless(piece(swayed, quarters, {7, 7, 8, 8}), near, tile, tolerance).surface.faces.size();
  };
  EXPECT_EQ(faces_at(1e-10), 4u);
  EXPECT_EQ(faces_at(1e-9), 2u);
}

}  // namespace
}  // namespace terrane
