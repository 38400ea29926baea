// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <set>
#include <vector>

#include "tests/support/lattice_checks.hpp"

// Tiles cut from one raster with shared samples along their edges, triangulated apart, meet vertex on vertex.
using namespace terrane;
using namespace terrane::testing;

namespace {

using Span = std::array<std::int64_t, 2>;

/// What a tile has on a line of samples: spans of border edges, by the number of the sample along the line.
struct Line {
  std::set<Span> edges;
  std::set<std::int64_t> steps;  // k: between samples k and k + 1

  bool covers(Span e) const {
    for (std::int64_t k = e[0]; k < e[1]; ++k) {
      if (!steps.count(k)) return false;
    }
    return true;
  }
  std::set<std::int64_t> forced;  // samples the tile has to keep, for its domain ends or changes beside them
};

/// Edges of the tile on column `at` (axis 0) or row `at` (axis 1) of the whole, rows counted from the north. The tile
/// lies at higher (side 1) or lower (side -1) numbers.
Line line_of(const Raster& whole, const Tin& tile, int axis, int at, int side) {
  Line line;
  const auto place = [&](Index v) {
    const Point& p = tile.vertices[v];
    return std::array<std::int64_t, 2>{std::llround((p.x - whole.x0) / whole.dx),
                                       std::llround((whole.y0 - p.y) / whole.dy)};
  };
  for (const Face& f : tile.faces) {
    for (int k = 0; k < 3; ++k) {
      const auto a = place(f[k]), b = place(f[(k + 1) % 3]);
      if (a[axis] != at || b[axis] != at) continue;
      const auto [low, high] = std::minmax(a[1 - axis], b[1 - axis]);
      line.edges.insert({low, high});
      for (std::int64_t s = low; s < high; ++s) line.steps.insert(s);
    }
  }
  const int length = axis == 0 ? whole.height : whole.width;
  const auto gone = [&](int across, int along) {
    return std::isnan(axis == 0 ? whole.at(across, along) : whole.at(along, across));
  };
  for (int k = 1; k + 1 < length; ++k) {
    bool plain = true;
    for (int d = -1; d <= 1; ++d) plain = plain && !gone(at, k + d) && !gone(at + side, k + d);
    if (!plain) line.forced.insert(k);
  }
  return line;
}

/// Every edge of one side that the other covers is an edge of the other. What voids that only one side has make it keep
/// within an edge of the other, the other cannot know.
void expect_meeting(const Line& a, const Line& b) {
  for (const Span e : a.edges) {
    if (!b.covers(e) || b.edges.count(e)) continue;
    const auto excuses = [&](const Span& f) {
      const auto within = [&](std::int64_t k) { return f[0] < k && k < f[1]; };
      return f[0] <= e[0] && e[1] <= f[1] &&
             (std::any_of(a.forced.begin(), a.forced.end(), within) ||
              std::any_of(b.forced.begin(), b.forced.end(), within));
    };
    EXPECT_TRUE(excuses(e) || std::any_of(b.edges.begin(), b.edges.end(), excuses))
        << "the edge from " << e[0] << " to " << e[1];
  }
}

/// Cuts the raster at these columns and rows, triangulates the tiles and compares all neighbours. Returns how many
/// edges the shared lines have.
std::size_t expect_tiles_meet(const Raster& whole, const std::vector<int>& columns, const std::vector<int>& rows,
                              double bound) {
  const std::size_t nx = columns.size() - 1, ny = rows.size() - 1;
  std::vector<Tin> tiles;
  for (std::size_t j = 0; j < ny; ++j) {
    for (std::size_t i = 0; i < nx; ++i) {
      const Triangulated t = run(window(whole, columns[i], rows[j], columns[i + 1] + 1, rows[j + 1] + 1), bound);
      EXPECT_LE(t.error, bound);
      tiles.push_back(t.tin);
    }
  }
  std::size_t edges = 0;
  const auto compare = [&](const Tin& first, const Tin& second, int axis, int at) {
    const Line a = line_of(whole, first, axis, at, -1), b = line_of(whole, second, axis, at, 1);
    expect_meeting(a, b);
    expect_meeting(b, a);
    edges += a.edges.size();
  };
  for (std::size_t j = 0; j < ny; ++j) {
    for (std::size_t i = 0; i < nx; ++i) {
      const Tin& tile = tiles[j * nx + i];
      if (i + 1 < nx) compare(tile, tiles[j * nx + i + 1], 0, columns[i + 1]);
      if (j + 1 < ny) compare(tile, tiles[(j + 1) * nx + i], 1, rows[j + 1]);
      if (i + 1 == nx || j + 1 == ny) continue;
      for (const std::size_t k : {j * nx + i, j * nx + i + 1, (j + 1) * nx + i, (j + 1) * nx + i + 1}) {
        for (const Span e : line_of(whole, tiles[k], 0, columns[i + 1], 1).edges) {
          EXPECT_TRUE(rows[j + 1] <= e[0] || rows[j + 1] >= e[1]) << "an edge past the corner of four tiles";
        }
      }
    }
  }
  return edges;
}

/// Cuts of 0 ... last into `parts` at random places.
std::vector<int> cuts(std::mt19937& random, int last, int parts) {
  std::set<int> at{0, last};
  while (static_cast<int>(at.size()) < parts + 1) at.insert(std::uniform_int_distribution<>(1, last - 1)(random));
  return {at.begin(), at.end()};
}

void dig(Raster& dem, int i0, int j0, int i1, int j1) {
  for (int j = std::max(0, j0); j < std::min(dem.height, j1); ++j) {
    for (int i = std::max(0, i0); i < std::min(dem.width, i1); ++i) {
      dem.samples[static_cast<std::size_t>(j) * dem.width + i] = nan_height;
    }
  }
}

}  // namespace

TEST(TriangulateTiles, OfAllSizesMeetOnBothAxesAndWhereFourMeet) {
  std::mt19937 random(3);
  for (int round = 0; round < 60; ++round) {
    const Raster whole = random_raster(random, 61 + round % 7, 60 + round % 5, 0, 12);
    for (const double bound : {0.25, 1.0, 2.0}) {
      const auto columns = cuts(random, whole.width - 1, 1 + round % 4), rows = cuts(random, whole.height - 1, 2);
      const std::size_t edges = expect_tiles_meet(whole, columns, rows, bound);
      const std::size_t samples = (columns.size() - 2) * (whole.height - 1) + (whole.width - 1);
      EXPECT_LT(edges, bound < 2 ? samples + 1 : samples) << "the border is not thinned";
      ASSERT_FALSE(HasFailure()) << "round " << round << ", bound " << bound;
    }
  }
}

TEST(TriangulateTiles, MeetWhereVoidsReachOrCrossTheirEdges) {
  std::mt19937 random(8);
  const auto below = [&](int n) { return std::uniform_int_distribution<>(0, n - 1)(random); };
  for (int round = 0; round < 200; ++round) {
    Raster whole = random_raster(random, 60, 50, std::array{0.0, 0.02, 0.3}[round % 3], 4);
    const auto columns = cuts(random, 59, 2 + round % 2), rows = cuts(random, 49, 2);
    for (int hole = 0; hole < 4; ++hole) {
      // Up to the shared line from one side, over it, along it, or on the corner of four tiles.
      const int x = columns[1], y = rows[1], a = below(60), b = below(50), n = 1 + below(12);
      if (hole == 0) dig(whole, x - n, b, x, b + n);
      if (hole == 1) dig(whole, a, y + 1, a + n, y + 1 + n);
      if (hole == 2) dig(whole, x - below(3), b, x + 1, b + n);
      if (hole == 3 && round % 4 == 0) dig(whole, x - below(3), y - below(3), x + 1, y + 1);
    }
    expect_tiles_meet(whole, columns, rows, std::array{0.25, 0.5, 1.5}[below(3)]);
    ASSERT_FALSE(HasFailure()) << "round " << round;
  }
}

TEST(TriangulateTiles, MeetWhenEachIsMadeOfBlocks) {
  std::mt19937 random(9);
  Raster whole = random_raster(random, 1501, 61, 0, 4);
  dig(whole, 690, 20, 702, 40);
  dig(whole, 300, 25, 330, 31);
  for (const int x : {700, 800}) {
    const std::size_t edges = expect_tiles_meet(whole, {0, x, 1500}, {0, 30, 60}, 0.5);
    EXPECT_GT(edges, 500u);
    EXPECT_LT(edges, 1000u);
  }
}

TEST(TriangulateTiles, OfRealTerrainMeet) {
  std::ifstream file(TERRANE_SOURCE_DIR "/../shared/data/tiles/N44W072.hgt", std::ios::binary);
  if (!file) GTEST_SKIP() << "tiles/N44W072.hgt is not here";
  Raster tile{1201, 1201, -72, 45, 1.0 / 1200, 1.0 / 1200, {}};
  for (char bytes[2]; file.read(bytes, 2);) {
    tile.samples.push_back(
        static_cast<std::int16_t>(static_cast<unsigned char>(bytes[0]) << 8 | static_cast<unsigned char>(bytes[1])));
  }
  ASSERT_EQ(tile.samples.size(), 1201u * 1201u);
  const Raster whole = window(tile, 500, 700, 901, 1101);  // Mount Washington
  const Triangulated t = run(whole, 20);
  EXPECT_LE(t.error, 20);
  EXPECT_LT(t.tin.vertices.size(), 20'000u);
  expect_correct(whole, t, 20);
  const std::size_t edges = expect_tiles_meet(whole, {0, 200, 400}, {0, 150, 400}, 20);
  EXPECT_GT(edges, 40u);
  EXPECT_LT(edges, 600u);
}
