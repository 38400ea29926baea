// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/raster.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/triangulate.hpp"
#include "tests/support/ascii_raster.hpp"

using namespace terrane;
using terrane::testing::ascii_raster;

namespace {

Raster moved(Raster r, double x, double y) {
  r.x0 += x;
  r.y0 += y;
  return r;
}

Raster cut(const Raster& whole, int i0, int j0, int i1, int j1) {
  Raster part{i1 - i0, j1 - j0, whole.x0 + i0 * whole.dx, whole.y0 - j0 * whole.dy, whole.dx, whole.dy, {}};
  for (int j = j0; j < j1; ++j) {
    for (int i = i0; i < i1; ++i) part.samples.push_back(whole.at(i, j));
  }
  return part;
}

Raster rough(int width, int height, std::mt19937& random) {
  Raster r{width, height, -72 + 1.0 / 2400, 45 - 1.0 / 2400, 1.0 / 1200, 1.0 / 1200, {}};
  for (int k = 0; k < width * height; ++k) r.samples.push_back(static_cast<double>(random() % 1000));
  return r;
}

void expect_same(const Raster& a, const Raster& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_NEAR(a.x0, b.x0, 1e-6 * b.dx);
  EXPECT_NEAR(a.y0, b.y0, 1e-6 * b.dy);
  ASSERT_EQ(a.samples.size(), b.samples.size());
  for (std::size_t k = 0; k < a.samples.size(); ++k) {
    ASSERT_TRUE(a.samples[k] == b.samples[k] || (std::isnan(a.samples[k]) && std::isnan(b.samples[k])));
  }
}

}  // namespace

TEST(Raster, TilesThatAbutBecomeOne) {
  std::mt19937 random(1);
  const Raster whole = rough(20, 30, random);
  std::vector<int> groups;
  const auto joined = join_on_lattice({cut(whole, 0, 0, 8, 30), cut(whole, 8, 0, 20, 30)}, false, groups);
  ASSERT_EQ(joined.size(), 1u);
  EXPECT_EQ(groups, (std::vector{0, 0}));
  expect_same(joined[0], whole);
}

TEST(Raster, TilesThatShareARowAreOneEvenWithoutJoiningOverlaps) {
  std::mt19937 random(2);
  const Raster whole = rough(20, 30, random);
  for (const bool join_overlaps : {false, true}) {
    std::vector<int> groups;
    const auto joined = join_on_lattice(
        {cut(whole, 9, 14, 20, 30), cut(whole, 0, 0, 10, 15), cut(whole, 9, 0, 20, 15), cut(whole, 0, 14, 10, 30)},
        join_overlaps, groups);
    ASSERT_EQ(joined.size(), 1u);
    expect_same(joined[0], whole);
  }
}

TEST(Raster, EqualOverlapsAreJoinedOnRequest) {
  std::mt19937 random(3);
  const Raster whole = rough(20, 30, random);
  const std::vector<Raster> tiles{cut(whole, 0, 0, 12, 30), cut(whole, 8, 0, 20, 30)};
  std::vector<int> groups;
  const auto joined = join_on_lattice(tiles, true, groups);
  ASSERT_EQ(joined.size(), 1u);
  expect_same(joined[0], whole);
  EXPECT_EQ(join_on_lattice(tiles, false, groups).size(), 2u);
  EXPECT_EQ(groups, (std::vector{0, 1}));
}

TEST(Raster, VoidsAreFilledFromTheOtherTile) {
  std::vector<int> groups;
  const auto joined = join_on_lattice({ascii_raster({"1.3", "45."}), ascii_raster({".23", "4.6"})}, true, groups);
  ASSERT_EQ(joined.size(), 1u);
  expect_same(joined[0], ascii_raster({"123", "456"}));
}

TEST(Raster, OverlapsThatDifferAreLeftApart) {
  std::vector<int> groups;
  EXPECT_EQ(
      join_on_lattice({ascii_raster({"123", "456"}), moved(ascii_raster({"23", "57"}), 1, 0)}, true, groups).size(),
      2u);
  // Also where it is only the shared column that differs.
  EXPECT_EQ(
      join_on_lattice({ascii_raster({"123", "456"}), moved(ascii_raster({"33", "77"}), 2, 0)}, true, groups).size(),
      2u);
}

TEST(Raster, OtherLatticesAreLeftApart) {
  const Raster a = ascii_raster({"11", "11"});
  std::vector<int> groups;
  EXPECT_EQ(join_on_lattice({a, moved(a, 2, 0)}, true, groups).size(), 1u);
  EXPECT_EQ(join_on_lattice({a, moved(a, 2 + 5e-7, 0)}, true, groups).size(), 1u);
  EXPECT_EQ(join_on_lattice({a, moved(a, 2 + 5e-6, 0)}, true, groups).size(), 2u);
  EXPECT_EQ(join_on_lattice({a, moved(a, 3, 0)}, true, groups).size(), 2u);
  EXPECT_EQ(join_on_lattice({a, moved(a, 2, 2)}, true, groups).size(), 2u) << "they touch at no sample's side";
  Raster b = moved(a, 2, 0);
  b.dx = 1.001;
  EXPECT_EQ(join_on_lattice({a, b}, true, groups).size(), 2u);
}

TEST(Raster, AContradictionKeepsTilesApartWhoeverJoinsThem) {
  // The middle one fits both others, which contradict each other.
  const Raster left = ascii_raster({"12345", "12345"}), right = moved(ascii_raster({"99567", "99567"}), 3, 0);
  const Raster below = moved(ascii_raster({"00000000", "00000000"}), 0, -2);
  std::vector<Raster> tiles{left, right, below};
  std::vector<int> order{0, 1, 2};
  std::vector<int> first;
  do {
    std::vector<int> groups;
    const auto joined = join_on_lattice({tiles[order[0]], tiles[order[1]], tiles[order[2]]}, true, groups);
    ASSERT_EQ(joined.size(), 2u);
    std::vector<int> by_tile(3);
    for (int k = 0; k < 3; ++k) by_tile[order[k]] = groups[k];
    EXPECT_NE(by_tile[0], by_tile[1]);
    const std::vector<int> relation{by_tile[0] == by_tile[2], by_tile[1] == by_tile[2]};
    if (first.empty()) first = relation;
    EXPECT_EQ(relation, first);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(Raster, AnyOrderGivesTheSameRasters) {
  std::mt19937 random(4);
  const Raster whole = rough(60, 60, random);
  std::vector<Raster> tiles;
  for (int j = 0; j < 60; j += 20) {
    for (int i = 0; i < 60; i += 20) {
      tiles.push_back(cut(whole, i, j, std::min(60, i + 20 + static_cast<int>(random() % 3)), j + 20));
    }
  }
  tiles.push_back(moved(tiles[0], 500 * whole.dx, 0));
  for (int round = 0; round < 20; ++round) {
    std::vector<Raster> given = tiles;
    std::shuffle(given.begin(), given.end(), random);
    std::vector<int> groups;
    const auto joined = join_on_lattice(given, true, groups);
    ASSERT_EQ(joined.size(), 2u);
    EXPECT_EQ(groups[0], 0);
    expect_same(joined[joined[0].width == 60 ? 0 : 1], whole);
  }
}

TEST(Raster, AMosaicThatWouldBeMostlyVoidIsNotMade) {
  // A long staircase of tiles, each touching the next.
  std::vector<Raster> tiles;
  for (int k = 0; k < 300; ++k)
    tiles.push_back(moved(Raster{50, 2, 0, 0, 1, 1, Array<double>(100, 1.0)}, 49.0 * k, k));
  std::vector<int> groups;
  const auto joined = join_on_lattice(tiles, true, groups);
  double samples = 0;
  for (const Raster& r : joined) samples += static_cast<double>(r.samples.size());
  EXPECT_GT(joined.size(), 1u);
  EXPECT_LE(samples, 4 * 300 * 100 + 1e6 * static_cast<double>(joined.size()));
}

TEST(Raster, OddOnesAreHandedThrough) {
  Raster broken = ascii_raster({"12", "34"});
  broken.dx = 0;
  std::vector<int> groups;
  EXPECT_EQ(join_on_lattice({Raster{}, broken, ascii_raster({"1"}), Raster{}}, true, groups).size(), 4u);
  EXPECT_TRUE(join_on_lattice({}, true, groups).empty());
}

TEST(Raster, JoinedPiecesTriangulateLikeTheWhole) {
  std::mt19937 random(5);
  Raster whole = rough(40, 40, random);
  whole.x0 = 0.5, whole.y0 = 99.5, whole.dx = whole.dy = 0.25;
  std::vector<int> groups;
  const auto joined =
      join_on_lattice({cut(whole, 0, 0, 13, 40), cut(whole, 13, 0, 40, 21), cut(whole, 13, 21, 40, 40)}, false, groups);
  ASSERT_EQ(joined.size(), 1u);
  Context context;
  EXPECT_EQ(triangulate(joined[0], {}, context).tin, triangulate(whole, {}, context).tin);
}
