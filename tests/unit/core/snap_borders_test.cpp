// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/snap_borders.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "core/merge.hpp"
#include "core/validate.hpp"
#include "support/checks.hpp"
#include "support/merge_judge.hpp"
#include "support/small_mesh.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::drawn;
using support::wrong_with;

SnappedTiles snapped(const std::vector<Tin>& tiles, double distance) {
  Context context;
  return snap_borders(tiles, distance, {}, context);
}

Tin merged(const std::vector<Tin>& tiles, Overlap overlap = Overlap::first) {
  Context context;
  return merge(tiles, {overlap, {}}, context).surface.tin;
}

/// Moves each vertex by up to `amount` along x and y: borders that nearly meet.
Tin shaken(Tin tin, double amount, std::uint64_t seed) {
  support::Random random(seed);
  for (Point& p : tin.vertices) {
    p.x += support::uniform(random, -amount, amount);
    p.y += support::uniform(random, -amount, amount);
  }
  return canonical(tin);
}

std::size_t holes_and_parts(const Tin& tin) {
  const Inspection seen = inspect(tin);
  return seen.holes + seen.components;
}

TEST(SnapBorders, VerticesGoToVertices) {
  const Tin west = drawn("1234\n2345\n3456"), east = support::shifted(west, 3.01, 0.004);
  const SnappedTiles result = snapped({west, east}, 0.05);
  EXPECT_EQ(result.report.moved, 3u);
  EXPECT_EQ(result.report.skipped, 0u);
  EXPECT_NEAR(result.report.max_move, std::hypot(0.01, 0.004), 1e-12);
  EXPECT_EQ(result.tiles[0], west) << "the first by content stays";
  EXPECT_EQ(wrong_with(result.tiles[1]), "");
  EXPECT_EQ(inspect(merged({west, east})).components, 2u);
  EXPECT_EQ(holes_and_parts(merged(result.tiles)), 1u);
}

TEST(SnapBorders, HeightsStayWithTheirVertices) {
  const Tin west = drawn("11\n11"), east = support::shifted(drawn("77\n77"), 1.01, 0);
  double lowest = 1e9;
  for (const Point& p : snapped({west, east}, 0.1).tiles[1].vertices) lowest = std::min(lowest, p.z);
  EXPECT_EQ(lowest, 7);
}

TEST(SnapBorders, VerticesGoToEdgesWhichGetAVertexThere) {
  const Tin west = drawn("0a\na0", 3), east = support::shifted(drawn("5555\n5555\n5555\n5555"), 3.02, 0);
  const SnappedTiles result = snapped({west, east}, 0.05);
  EXPECT_EQ(result.report.moved, 4u);
  EXPECT_EQ(result.report.inserted, 2u);
  EXPECT_EQ(holes_and_parts(merged(result.tiles)), 1u);
  for (const Tin& tile : result.tiles) EXPECT_EQ(wrong_with(tile), "");
}

TEST(SnapBorders, NothingBeyondTheDistanceMoves) {
  const Tin west = drawn("11\n11"), east = support::shifted(west, 1.2, 0);
  const SnappedTiles result = snapped({west, east}, 0.1);
  EXPECT_EQ(result.tiles[0], west);
  EXPECT_EQ(result.tiles[1], east);
  EXPECT_EQ(result.report.moved + result.report.skipped + result.report.inserted, 0u);
}

TEST(SnapBorders, AMoveThatTurnsAFaceOverIsSkippedAndCounted) {
  // The eastern tile's first column is thinner than the distance: both its columns would go to the western border.
  const Tin west = drawn("11\n11");
  Tin east = support::shifted(drawn("222\n222"), 1.05, 0);
  for (Point& p : east.vertices)
    if (p.x == 2.05) p.x = 1.06;
  const SnappedTiles result = snapped({west, canonical(east)}, 0.2);
  for (const Tin& tile : result.tiles) EXPECT_EQ(wrong_with(tile), "");
  EXPECT_GT(result.report.skipped, 0u);
  EXPECT_EQ(holes_and_parts(merged(result.tiles)), 1u);
}

TEST(SnapBorders, ShakenTilesMeetInAnyOrder) {
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Tin> tiles;
    for (int i = 0; i < 4; ++i)
      tiles.push_back(shaken(support::patch(10.0 * (i % 2), 10.0 * (i / 2), 9 + 3 * i, 9 + 3 * i, 10.0 / (9 + 3 * i)),
                             0.02, 100 + static_cast<std::uint64_t>(10 * trial + i)));
    const SnappedTiles result = snapped(tiles, 0.08);
    for (const Tin& tile : result.tiles) ASSERT_EQ(wrong_with(tile), "");
    EXPECT_LE(result.report.max_move, 0.08);
    const Tin whole = merged(result.tiles);
    EXPECT_EQ(holes_and_parts(whole), 1u) << "trial " << trial;
    std::vector<int> order(tiles.size());
    std::iota(order.begin(), order.end(), 0);
    for (int turn = 0; turn < 6; ++turn) {
      std::next_permutation(order.begin(), order.end());
      std::vector<Tin> permuted;
      for (const int i : order) permuted.push_back(tiles[i]);
      const SnappedTiles again = snapped(permuted, 0.08);
      for (std::size_t i = 0; i < order.size(); ++i) ASSERT_EQ(again.tiles[i], result.tiles[order[i]]);
      EXPECT_EQ(again.report.moved, result.report.moved);
      EXPECT_EQ(again.report.skipped, result.report.skipped);
    }
  }
}

TEST(SnapBorders, AnyMeshesStayValid) {
  support::Random random(5);
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<Tin> tiles;
    for (int i = 0; i < 3; ++i) {
      std::vector<Point> points;
      for (int p = 0; p < 8; ++p)
        points.push_back(
            {support::uniform(random, 0, 10), support::uniform(random, 0, 10), 1.0 * support::below(random, 5)});
      Tin tile = canonical(support::flipped(support::swept(points), 3, random));
      if (support::below(random, 2) == 0)
        tile = support::without(tile, [&](Point2) { return support::below(random, 3) == 0; });
      if (!tile.faces.empty()) tiles.push_back(tile);
    }
    const SnappedTiles result = snapped(tiles, support::uniform(random, 0.01, 2));
    for (const Tin& tile : result.tiles) ASSERT_EQ(support::wrong_with_surface(tile, true), "") << "trial " << trial;
    if (trial % 10 == 0) {
      const MergeOptions options{Overlap::mean, {}};
      Context context;
      EXPECT_EQ(support::broken_promises(result.tiles, options, merge(result.tiles, options, context)), "");
    }
  }
}

TEST(SnapBorders, ManyTilesTakeSeconds) {
  std::vector<Tin> tiles;
  for (int i = 0; i < 64; ++i)
    tiles.push_back(shaken(support::patch(10.0 * (i % 8), 10.0 * (i / 8), 60, 60, 10.0 / 60), 0.01,
                           7 + static_cast<std::uint64_t>(i)));
  const auto start = std::chrono::steady_clock::now();
  const SnappedTiles result = snapped(tiles, 0.05);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 20);
  EXPECT_GT(result.report.moved, 5000u);
  EXPECT_EQ(holes_and_parts(merged(result.tiles)), 1u);
}

}  // namespace
}  // namespace terrane
