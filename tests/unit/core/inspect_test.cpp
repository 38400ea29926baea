// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/validate.hpp"

namespace terrane {
namespace {

/// A TIN of the unit cells drawn with '#', rows from the north; each cell is cut in two, corners are shared.
Tin drawn(const std::vector<std::string>& rows) {
  Tin tin;
  std::map<std::pair<int, int>, Index> at;
  const auto corner = [&](int x, int y) {
    const auto [found, fresh] = at.emplace(std::pair(x, y), static_cast<Index>(tin.vertices.size()));
    if (fresh) tin.vertices.push_back({double(x), double(y), 0});
    return found->second;
  };
  for (int row = 0; row < static_cast<int>(rows.size()); ++row)
    for (int x = 0; x < static_cast<int>(rows[row].size()); ++x) {
      if (rows[row][x] != '#') continue;
      const int y = static_cast<int>(rows.size()) - 1 - row;
      tin.faces.push_back({corner(x, y), corner(x + 1, y), corner(x + 1, y + 1)});
      tin.faces.push_back({corner(x, y), corner(x + 1, y + 1), corner(x, y + 1)});
    }
  return tin;
}

std::pair<std::size_t, std::size_t> components_and_holes(const std::vector<std::string>& rows) {
  const Inspection result = inspect(drawn(rows));
  EXPECT_EQ(result.overlaps + result.t_junctions + result.inverted + result.non_manifold_edges, 0u);
  return {result.components, result.holes};
}

using Counts = std::pair<std::size_t, std::size_t>;

TEST(Inspect, CountsComponentsAndHoles) {
  EXPECT_EQ(components_and_holes({"##", "##"}), Counts(1, 0));
  EXPECT_EQ(components_and_holes({"#.#"}), Counts(2, 0));
  EXPECT_EQ(components_and_holes({"###", "#.#", "###"}), Counts(1, 1));
  EXPECT_EQ(components_and_holes({"#####", "#.#.#", "#####"}), Counts(1, 2));
  EXPECT_EQ(components_and_holes({"#####", "#...#", "#.#.#", "#...#", "#####"}), Counts(2, 1));  // an island in a lake
}

// As in a polygon of the simple feature model: two holes that touch in a corner are two, a hole may touch the outer
// border in a corner, parts that touch in a corner are apart, and what two parts enclose together is a hole of neither.
TEST(Inspect, PinchesDoNotConfuseTheCounts) {
  EXPECT_EQ(components_and_holes({"####", "#.##", "##.#", "####"}), Counts(1, 2));
  EXPECT_EQ(components_and_holes({".##", "#.#", "###"}), Counts(1, 1));
  EXPECT_EQ(components_and_holes({"#.", ".#"}), Counts(2, 0));
  EXPECT_EQ(components_and_holes({".##", "#.#", "##."}), Counts(2, 0));
}

TEST(Inspect, WallsAreLookedThrough) {
  Tin tin = drawn({"##"});
  // Lift the eastern cell on vertices of its own and close the jump.
  const auto n = static_cast<Index>(tin.vertices.size());
  std::map<Index, Index> lifted;
  for (int f = 2; f < 4; ++f)
    for (Index& v : tin.faces[f]) {
      const auto [at, fresh] = lifted.emplace(v, n + static_cast<Index>(lifted.size()));
      if (fresh) tin.vertices.push_back({tin.vertices[v].x, tin.vertices[v].y, 5});
      v = at->second;
    }
  const Index low_south = tin.faces[0][1], low_north = tin.faces[0][2];
  tin.faces.push_back({low_south, lifted[low_south], low_north});
  tin.faces.push_back({lifted[low_south], lifted[low_north], low_north});
  const Inspection result = inspect(tin);
  EXPECT_EQ(result.walls, 2u);
  EXPECT_EQ(result.components, 1u);
  EXPECT_EQ(result.holes, 0u);
  EXPECT_EQ(result.degenerate + result.non_manifold_edges + result.t_junctions, 0u);
}

TEST(Inspect, CountsWhatIsWrong) {
  Tin tin{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {2, 0, 0}, {2, -1, 0}, {1, 1, 0}, {3, 3, 0}}, {}};
  tin.faces = {{0, 1, 2}, {3, 0, 4}, {0, 5, 6}, {1, 6, 2}};  // touched at 3, ..., flat, ...
  Inspection result = inspect(tin);
  EXPECT_EQ(result.degenerate, 1u);
  EXPECT_EQ(result.t_junctions, 1u);
  EXPECT_EQ(result.inverted, 0u);
  tin.faces = {{0, 1, 2}, {3, 4, 0}};
  result = inspect(tin);
  EXPECT_EQ(result.inverted, 1u);
  EXPECT_EQ(result.overlaps, 0u);
  EXPECT_EQ(result.t_junctions, 1u);
  tin.faces = {{0, 1, 2}, {0, 1, 5}};
  result = inspect(tin);
  EXPECT_EQ(result.non_manifold_edges, 1u);
  EXPECT_EQ(result.overlaps, 1u);
}

TEST(Inspect, NeverThrows) {
  Tin tin{{{0, 0, 0}, {NAN, 0, 0}, {0, INFINITY, 0}, {1e308, 1e308, 0}, {-1e308, 1e308, 0}}, {}};
  tin.faces = {{0, 1, 2}, {0, 3, 4}, {0, 3, 99}, {-5, 3, 4}, {0, 0, 0}};
  const Inspection result = inspect(tin);
  EXPECT_EQ(result.faces, 5u);
  EXPECT_EQ(result.degenerate, 4u);
  EXPECT_EQ(inspect(Tin{}).components, 0u);
}

// In canonical order a sound surface is known by its border alone; in any other order it is taken apart whole.
TEST(Inspect, SaysTheSameInEveryOrder) {
  std::mt19937 random(5);
  int unsound = 0;
  for (int run = 0; run < 2000; ++run) {
    Tin tin;
    for (int sheets = random() % 4 == 0 ? 2 : 1; sheets > 0; --sheets) {
      std::vector<std::string> rows(4, std::string(5, '.'));
      for (std::string& row : rows)
        for (char& cell : row) cell = random() % 4 == 0 ? '.' : '#';
      const Tin sheet = drawn(rows);
      const auto first = static_cast<Index>(tin.vertices.size());
      const double shift = tin.faces.empty() ? 0 : static_cast<double>(random() % 11) / 2, z = random() % 2;
      for (const Point& p : sheet.vertices) tin.vertices.push_back({p.x + shift, p.y, z});
      for (const Face& f : sheet.faces) tin.faces.push_back({first + f[0], first + f[1], first + f[2]});
    }
    if (tin.faces.empty()) continue;
    if (random() % 8 == 0) std::swap(tin.faces[random() % tin.faces.size()][1], tin.faces[0][1]);
    tin = canonical(tin);
    Tin turned = tin;
    for (Face& f : turned.faces) std::rotate(f.begin(), f.begin() + 1, f.end());
    const auto faults = [](const Inspection& i) {
      return i.inverted + i.degenerate + i.t_junctions + i.non_manifold_edges + i.overlaps;
    };
    const Inspection quick = inspect(tin), slow = inspect(turned);
    EXPECT_EQ(faults(quick) == 0, faults(slow) == 0) << "run " << run;
    unsound += faults(slow) > 0;
    if (faults(slow) == 0) {
      EXPECT_EQ(std::tuple(quick.components, quick.holes), std::tuple(slow.components, slow.holes)) << "run " << run;
    }
  }
  EXPECT_GT(unsound, 200);
  EXPECT_LT(unsound, 1000);
}

// Against brute force: random triangles, some of which overlap. Overlap by clipping areas would round, so the truth is
// taken on a lattice of small integers where every sum is exact.
TEST(Inspect, AgreesWithBruteForceOnRandomSoups) {
  std::mt19937 random(11);
  int sound = 0, unsound = 0;
  for (int run = 0; run < 4000; ++run) {
    Tin tin;
    const int faces = 2 + static_cast<int>(random() % 2);
    for (int f = 0; f < faces; ++f) {
      for (int k = 0; k < 3; ++k) tin.vertices.push_back({double(random() % 6), double(random() % 6), 0});
      tin.faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
    }
    const auto side = [](Point a, Point b, Point c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); };
    bool flat = false;
    for (Face& f : tin.faces) {
      const double s = side(tin.vertices[f[0]], tin.vertices[f[1]], tin.vertices[f[2]]);
      flat = flat || s == 0;
      if (s < 0) std::swap(f[1], f[2]);
    }
    if (flat) continue;
    bool overlaps = false;
    for (int f = 0; f < faces; ++f)
      for (int g = 0; g < f; ++g) {
        bool apart = false;
        for (int turn = 0; turn < 2; ++turn)
          for (int k = 0; k < 3; ++k) {
            const Face &s = tin.faces[turn ? f : g], &t = tin.faces[turn ? g : f];
            bool behind = true;
            for (const Index v : t)
              behind = behind && side(tin.vertices[s[k]], tin.vertices[s[(k + 1) % 3]], tin.vertices[v]) <= 0;
            apart = apart || behind;
          }
        overlaps = overlaps || !apart;
      }
    const Inspection result = inspect(tin);
    EXPECT_EQ(result.overlaps > 0, overlaps) << "run " << run;
    (overlaps ? unsound : sound) += 1;
    const auto defects = find_defects(tin);
    bool listed = false;  // faces that are equal are mended, not refused
    for (const Defect& defect : defects)
      listed = listed || defect.code == "overlapping-faces" || defect.code == "duplicate-face";
    EXPECT_EQ(listed, overlaps) << "run " << run;
  }
  EXPECT_GT(sound, 100);
  EXPECT_GT(unsound, 100);
}

}  // namespace
}  // namespace terrane
