// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/volume_areas.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <string>

#include "core/face_runs.hpp"
#include "core/plan/zone_polygons.hpp"
#include "core/plan_region.hpp"
#include "core/validate.hpp"
#include "support/polygons.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::Polygons;

double ring_area(const Line& ring) {
  double sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point &a = ring[i], &b = ring[(i + 1) % ring.size()];
    sum += (a.x - ring[0].x) * (b.y - ring[0].y) - (b.x - ring[0].x) * (a.y - ring[0].y);
  }
  return sum / 2;
}

double polygon_area(const Polygon& polygon) {
  double sum = ring_area(polygon.outer);
  for (const Line& hole : polygon.holes) sum += ring_area(hole);  // clockwise
  return sum;
}

/// Simple rings: no corner twice.
void expect_simple(const Polygon& polygon) {
  std::vector<Line> rings = polygon.holes;
  rings.push_back(polygon.outer);
  for (const Line& ring : rings) {
    ASSERT_GE(ring.size(), 3u);
    std::set<std::pair<double, double>> corners;
    for (const Point& p : ring) EXPECT_TRUE(corners.insert({p.x, p.y}).second) << p.x << " " << p.y;
  }
  EXPECT_GT(ring_area(polygon.outer), 0);
  for (const Line& hole : polygon.holes) EXPECT_LT(ring_area(hole), 0);
}

struct Total {
  double volume = 0, area_2d = 0, area_3d = 0, max_dz = 0;
};

void expect_adds_up(const VolumeAreas& areas, const Volume& whole) {
  std::map<VolumeKind, Total> totals;
  for (const VolumeArea& area : areas.areas) {
    expect_simple(area.polygon);
    EXPECT_NEAR(polygon_area(area.polygon), area.area_2d, 1e-9 * whole.overlap_area_2d);
    Total& to = totals[area.kind];
    to.volume += area.volume, to.area_2d += area.area_2d, to.area_3d += area.area_3d;
    to.max_dz = std::max(to.max_dz, area.max_dz);
  }
  const double volume = 1e-10 * (1 + whole.fill.volume + whole.cut.volume), plan = 1e-10 * (1 + whole.overlap_area_2d);
  for (const auto& [kind, side] : {std::pair(VolumeKind::above, whole.fill), std::pair(VolumeKind::below, whole.cut)}) {
    EXPECT_NEAR(totals[kind].volume, side.volume, volume);
    EXPECT_NEAR(totals[kind].area_2d, side.area_2d, plan);
    EXPECT_NEAR(totals[kind].area_3d, side.area_3d, plan);
    EXPECT_NEAR(totals[kind].max_dz, side.max_dz, 1e-9);
  }
  EXPECT_NEAR(totals[VolumeKind::same].area_2d, whole.same_area_2d, plan);
  EXPECT_NEAR(totals[VolumeKind::same].area_3d, whole.same_area_3d, plan);
}

std::vector<std::vector<Point2>> rings_of(const Polygon& polygon) {
  std::vector<std::vector<Point2>> rings;
  const auto add = [&](const Line& line) {
    rings.emplace_back();
    for (const Point& p : line) rings.back().push_back(plan(p));
  };
  add(polygon.outer);
  for (const Line& hole : polygon.holes) add(hole);
  return rings;
}

std::string wkt_of(const VolumeAreas& areas, VolumeKind kind) {
  std::string wkt;
  for (const VolumeArea& area : areas.areas) {
    if (area.kind != kind) continue;
    wkt += wkt.empty() ? "MULTIPOLYGON((" : ",(";
    std::string rings;
    for (auto ring : rings_of(area.polygon)) {
      ring.push_back(ring.front());
      std::string corners;
      for (const Point2 p : ring) {
        char text[64];
        std::snprintf(text, sizeof text, "%s%.17g %.17g", corners.empty() ? "" : ",", p.x, p.y);
        corners += text;
      }
      rings += (rings.empty() ? "(" : ",(") + corners + ")";
    }
    wkt += rings + ")";
  }
  return wkt.empty() ? wkt : wkt + ")";
}

Tin terrain(int points, std::uint64_t seed) {
  Context context;
  return checked(support::random_terrain(points, seed), "t", context);
}

/// Unit squares of a drawing, two faces each; a letter is a zone.
ZonedMesh drawn(const std::vector<std::string>& rows) {
  ZonedMesh mesh;
  const int width = static_cast<int>(rows[0].size()), height = static_cast<int>(rows.size());
  for (int j = 0; j <= height; ++j)
    for (int i = 0; i <= width; ++i) mesh.points.push_back({1.0 * i, 1.0 * (height - j)});
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      if (rows[j][i] == ' ') continue;
      const Index nw = j * (width + 1) + i, sw = nw + width + 1;
      mesh.faces.push_back({sw, sw + 1, nw + 1});
      mesh.faces.push_back({sw, nw + 1, nw});
      mesh.zone.insert(mesh.zone.end(), 2, rows[j][i] - 'a');
    }
  return mesh;
}

}  // namespace

TEST(ZonePolygons, HolesIslandsAndTouchingCorners) {
  const auto polygons = zone_polygons(drawn({
      "aaaaaa",
      "abbbba",
      "abaaba",
      "abbbba",
      "aaaaaa",
  }));
  ASSERT_EQ(polygons.size(), 2u);
  ASSERT_EQ(polygons[0].size(), 2u) << "the frame, and the island in b";
  ASSERT_EQ(polygons[1].size(), 1u);
  EXPECT_EQ(polygons[0][0].holes.size(), 1u);
  EXPECT_EQ(polygons[0][1].holes.size(), 0u);
  EXPECT_EQ(polygons[1][0].holes.size(), 1u);
  EXPECT_DOUBLE_EQ(polygon_area(polygons[0][0]), 18);
  EXPECT_DOUBLE_EQ(polygon_area(polygons[0][1]), 2);
  EXPECT_DOUBLE_EQ(polygon_area(polygons[1][0]), 10);
}

TEST(ZonePolygons, ABorderThatTouchesItselfIsSeveralRings) {
  const auto polygons = zone_polygons(drawn({
      "bbbb",
      "baab",
      "bab ",
      "bbba",
  }));
  // b's tips touch at a corner; the outermost a lies beyond it.
  ASSERT_EQ(polygons[1].size(), 1u);
  expect_simple(polygons[1][0]);
  EXPECT_EQ(polygons[1][0].holes.size(), 1u);
  EXPECT_DOUBLE_EQ(polygon_area(polygons[1][0]), 11);
  ASSERT_EQ(polygons[0].size(), 2u) << "pieces that touch in a corner are two";

  const auto ring = zone_polygons(drawn({
      "aaa ",
      "a aa",
      "aa a",
      " aaa",
  }));
  ASSERT_EQ(ring[0].size(), 1u);
  expect_simple(ring[0][0]);
  EXPECT_EQ(ring[0][0].holes.size(), 2u) << "two holes that touch in a corner";
  EXPECT_DOUBLE_EQ(polygon_area(ring[0][0]), 12);
}

TEST(VolumeAreas, TwoPlanesThatCross) {
  Context context;
  const Tin surface{{{0, 0, -1}, {2, 0, 1}, {2, 1, 1}, {0, 1, -1}}, {{0, 1, 2}, {0, 2, 3}}};
  const VolumeAreas areas = volume_areas(surface, 0.0, 0, nullptr, nullptr, context);
  ASSERT_EQ(areas.areas.size(), 2u);
  EXPECT_EQ(areas.areas[0].kind, VolumeKind::above);
  EXPECT_EQ(areas.areas[1].kind, VolumeKind::below);
  for (const VolumeArea& area : areas.areas) {
    EXPECT_DOUBLE_EQ(area.volume, 0.5);
    EXPECT_DOUBLE_EQ(area.area_2d, 1);
    EXPECT_DOUBLE_EQ(area.area_3d, std::sqrt(2.0));
    EXPECT_DOUBLE_EQ(area.max_dz, 1);
    EXPECT_EQ(area.polygon.outer.size(), 4u) << "the diagonal leaves no trace";
  }
  const VolumeAreas tolerant = volume_areas(surface, 0.0, 0.5, nullptr, nullptr, context);
  ASSERT_EQ(tolerant.areas.size(), 3u);
  EXPECT_EQ(tolerant.areas[1].kind, VolumeKind::same);
  EXPECT_DOUBLE_EQ(tolerant.areas[1].area_2d, 1);
  EXPECT_EQ(tolerant.areas[1].volume, 0);
  EXPECT_DOUBLE_EQ(tolerant.areas[0].volume, 0.375);
}

TEST(VolumeAreas, WhatDiffersByNothingOrByTheToleranceIsSame) {
  Context context;
  const Tin flat{{{0, 0, 5}, {2, 0, 5}, {2, 1, 5}, {0, 1, 5}}, {{0, 1, 2}, {0, 2, 3}}};
  for (const auto& [level, tolerance] : {std::pair(5.0, 0.0), std::pair(4.5, 0.5), std::pair(5.5, 0.5)}) {
    const VolumeAreas areas = volume_areas(flat, level, tolerance, nullptr, nullptr, context);
    ASSERT_EQ(areas.areas.size(), 1u);
    EXPECT_EQ(areas.areas[0].kind, VolumeKind::same);
    expect_adds_up(areas, volume(flat, level, tolerance, nullptr, context));
  }
  EXPECT_EQ(volume_areas(flat, 4.5, 0.25, nullptr, nullptr, context).areas.at(0).kind, VolumeKind::above);
  EXPECT_EQ(volume_areas(flat, 5.5, 0.25, nullptr, nullptr, context).areas.at(0).kind, VolumeKind::below);
  EXPECT_TRUE(volume_areas(flat, Tin{}, 0, nullptr, nullptr, context).areas.empty());
}

TEST(VolumeAreas, RandomSurfacesArePartitioned) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Context context;
    const Tin a = terrain(400, seed);
    Tin b = seed % 2 ? terrain(300, seed + 50) : support::shifted(support::edited(a, 1.5), seed == 4 ? 700 : 0, 0);
    if (seed == 6) b = support::with_holes(a);
    Context other;
    b = checked(b, "b", other);
    for (const double tolerance : {0.0, 0.3}) {
      const VolumeAreas areas = volume_areas(a, b, tolerance, nullptr, nullptr, context);
      const Volume whole = volume(a, b, tolerance, nullptr, context);
      expect_adds_up(areas, whole);
      // By GEOS: of one kind they touch in points alone, and no two kinds share an area.
      double sum = 0;
      std::vector<Polygons> kinds;
      for (const VolumeKind kind : {VolumeKind::above, VolumeKind::same, VolumeKind::below}) {
        const std::string wkt = wkt_of(areas, kind);
        if (wkt.empty()) continue;
        kinds.push_back(Polygons::from_wkt(wkt));
        EXPECT_EQ(kinds.back().invalidity(), "") << "seed " << seed;
        sum += kinds.back().area();
      }
      for (std::size_t i = 0; i < kinds.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) EXPECT_LT(kinds[i].shared_area(kinds[j]), 1e-12 * whole.overlap_area_2d);
      EXPECT_NEAR(sum, whole.overlap_area_2d, 1e-9 * whole.overlap_area_2d);
    }
  }
}

TEST(VolumeAreas, FlatPartsInASlopingSurface) {
  // Terraces at 0 between slopes: same where level, above and below beside.
  Tin tin;
  const double heights[] = {-1, 0, 0, 1, 0, 0, -2};
  for (int i = 0; i < 7; ++i)
    for (int j = 0; j < 2; ++j) tin.vertices.push_back({1.0 * i, 1.0 * j, heights[i]});
  for (Index i = 0; i < 6; ++i) {
    tin.faces.push_back({2 * i, 2 * i + 2, 2 * i + 3});
    tin.faces.push_back({2 * i, 2 * i + 3, 2 * i + 1});
  }
  Context context;
  const VolumeAreas areas = volume_areas(tin, 0.0, 0, nullptr, nullptr, context);
  ASSERT_EQ(areas.areas.size(), 5u);
  std::map<VolumeKind, int> count;
  for (const VolumeArea& area : areas.areas) ++count[area.kind];
  EXPECT_EQ(count[VolumeKind::above], 1);
  EXPECT_EQ(count[VolumeKind::same], 2);
  EXPECT_EQ(count[VolumeKind::below], 2);
  expect_adds_up(areas, volume(tin, 0.0, 0, nullptr, context));
}

TEST(VolumeAreas, TheSameBytesOnAnyThreads) {
  const Tin a = terrain(3000, 21), b = terrain(2500, 22);
  Context one, three;
  three.threads = 3;
  const VolumeAreas x = volume_areas(a, b, 0.1, nullptr, nullptr, one),
                    y = volume_areas(a, b, 0.1, nullptr, nullptr, three);
  ASSERT_EQ(x.areas.size(), y.areas.size());
  for (std::size_t i = 0; i < x.areas.size(); ++i) {
    EXPECT_EQ(x.areas[i].volume, y.areas[i].volume);
    EXPECT_EQ(rings_of(x.areas[i].polygon), rings_of(y.areas[i].polygon));
  }
}

TEST(FaceRuns, FindsWhatTouchesABox) {
  const Tin tin = terrain(2000, 5);
  const FaceRuns runs(tin);
  for (const Box& box : {Box{2000, 3000, 2500, 3700}, Box{0, 0, 10, 10}, Box{5000, 5000, 5000, 5000},
                         Box{-500, -500, 20000, 20000}, Box{20000, 0, 20001, 1}}) {
    std::size_t expected = 0;
    for (const Face& f : tin.faces) {
      double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
      for (const Index v : f) {
        low[0] = std::min(low[0], tin.vertices[v].x), high[0] = std::max(high[0], tin.vertices[v].x);
        low[1] = std::min(low[1], tin.vertices[v].y), high[1] = std::max(high[1], tin.vertices[v].y);
      }
      expected += low[0] <= box.xmax && high[0] >= box.xmin && low[1] <= box.ymax && high[1] >= box.ymin;
    }
    const Tin near = runs.near(box);
    EXPECT_EQ(near.faces.size(), expected);
    Context context;
    EXPECT_TRUE(near.faces.empty() || find_defects(near).empty());
  }
}

}  // namespace terrane
