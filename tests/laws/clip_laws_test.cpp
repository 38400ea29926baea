// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/clip.hpp"
#include "core/merge.hpp"
#include "core/validate.hpp"
#include "core/volume.hpp"
#include "support/checks.hpp"
#include "support/clip_checks.hpp"
#include "support/terrains.hpp"

// What the inside and the outside of any region must satisfy on any surface: together they are the surface.
namespace terrane {
namespace {

using support::Random;
using support::wrong_with_clips;

/// A few polygons over a box, some with holes; corners may lie on vertices of the surface, edges along its edges.
std::vector<Polygon> random_region(const Tin& surface, Random& random) {
  const Box box = bounds(surface);
  const double size = std::max(box.xmax - box.xmin, box.ymax - box.ymin);
  const auto any_vertex = [&] {
    return surface
        .vertices[static_cast<std::size_t>(support::below(random, static_cast<int>(surface.vertices.size())))];
  };
  std::vector<Polygon> polygons;
  for (int n = 1 + support::below(random, 3); n > 0; --n) {
    const Point2 centre{support::uniform(random, box.xmin, box.xmax), support::uniform(random, box.ymin, box.ymax)};
    Polygon p{support::star(centre, 0.1 * size, 0.6 * size, 3 + support::below(random, 12), random), {}};
    if (support::below(random, 2)) p.holes.push_back(support::star(centre, 0.01 * size, 0.2 * size, 5, random));
    if (support::below(random, 3) == 0)
      for (Point& corner : p.outer)
        if (support::below(random, 2)) corner = any_vertex();
    if (support::below(random, 4) == 0) {  // the outline of a face, so that every edge is one of the mesh
      const Face& f = surface.faces[support::below(random, static_cast<int>(surface.faces.size()))];
      p = {{surface.vertices[f[0]], surface.vertices[f[1]], surface.vertices[f[2]]}, {}};
    }
    polygons.push_back(p);
  }
  return polygons;
}

TEST(ClipLaws, InsideAndOutsideAreTheWhole) {
  const std::vector<Tin> surfaces = {
      support::random_terrain(150, 1),
      support::grid_terrain(8, true),
      support::with_holes(support::random_terrain(200, 2)),
      support::islands(support::random_terrain(300, 3)),
      support::l_shape(support::grid_terrain(10, false)),
      support::shifted(support::random_terrain(120, 4), 500000, 4500000),
      support::stepped(100, 5, 1e-6),
  };
  Random random(11);
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    for (int round = 0; round < 40; ++round) {
      const auto polygons = random_region(surfaces[s], random);
      EXPECT_EQ(wrong_with_clips(surfaces[s], polygons, round), "") << "surface " << s << ", round " << round;
    }
}

TEST(ClipLaws, RegionsAnUlpBesideMeshEdges) {
  Random random(12);
  for (const double at : {0.0, 4194304.0}) {
    const Tin surface = support::shifted(support::grid_terrain(6, true), at, at);
    for (int round = 0; round < 60; ++round) {
      const Face& f = surface.faces[support::below(random, static_cast<int>(surface.faces.size()))];
      Polygon p;
      for (const Index v : f) {
        Point corner = surface.vertices[v];
        for (double* c : {&corner.x, &corner.y})
          for (int n = support::below(random, 12) - 6; n != 0; n += n > 0 ? -1 : 1)
            *c = std::nextafter(*c, n > 0 ? 1e9 : -1e9);
        p.outer.push_back(corner);
      }
      EXPECT_EQ(wrong_with_clips(surface, {p}, round), "") << "at " << at << ", round " << round;
    }
  }
}

TEST(ClipLaws, WallsTooAreTheWhole) {
  Random random(13);
  Context context;
  for (int round = 0; round < 40; ++round) {
    const Tin low = support::patch(0, 0, 5, 5, 1);
    const Tin high = support::patch(support::uniform(random, 0, 3), support::uniform(random, 0, 3), 3, 2, 1, 3);
    const Tin tin = merge({high, low}, {Overlap::first, {Seam::wall, 0}}, context).surface.tin;
    const Point2 centre{support::uniform(random, 0, 5), support::uniform(random, 0, 5)};
    const std::vector<Polygon> polygons = {{support::star(centre, 0.3, 4, 9, random), {}}};
    EXPECT_EQ(wrong_with_clips(tin, polygons, round), "");
    const PlanRegion region = plan_region(polygons, context);
    const Tin in = clip(tin, region, Side::inside, context).tin, out = clip(tin, region, Side::outside, context).tin;
    for (const Tin& part : {in, out, support::put_together(in, out)}) EXPECT_EQ(support::open_seams(part), "");
    EXPECT_NEAR(support::wall_area(in) + support::wall_area(out), support::wall_area(tin), 1e-9);
    const Tin again = merge({in, out}, {Overlap::first, {Seam::wall, 0}}, context).surface.tin;
    EXPECT_EQ(support::wrong_with(again), "");
    EXPECT_NEAR(support::wall_area(again), support::wall_area(tin), 1e-9);
    EXPECT_NEAR(plan_area(again), plan_area(tin), 1e-12 * plan_area(tin));
  }
}

TEST(ClipLaws, PartsOfAPartitionAreTheWhole) {
  const Tin terrain = support::random_terrain(400, 14);
  Context context;
  std::vector<Tin> parts;
  for (int i = 0; i < 9; ++i) {
    const double x = (i % 3) * 3500.0 - 10, y = (i / 3) * 3500.0 - 10;
    parts.push_back(clip(terrain, plan_region(Box{x, y, x + 3500, y + 3500}), Side::inside, context).tin);
    EXPECT_EQ(support::wrong_with(parts.back()), "");
  }
  const Tin whole = merge(parts, {Overlap::first, {Seam::wall, 0}}, context).surface.tin;
  EXPECT_EQ(support::wrong_with(whole), "");
  EXPECT_EQ(inspect(whole).walls, 0u);
  EXPECT_EQ(inspect(whole).components, 1u);
  EXPECT_NEAR(plan_area(whole), plan_area(terrain), 1e-12 * plan_area(terrain));
  const support::Sampler before(terrain), after(whole);
  for (const Point2 p : support::random_places(bounds(terrain), 3000, 15)) EXPECT_NEAR(before(p), after(p), 1e-7);
}

TEST(ClipLaws, ShuffledSurfacesGiveTheSameBytes) {
  Random random(16);
  const Tin terrain = support::random_terrain(300, 17);
  const auto polygons = random_region(terrain, random);
  Context context;
  const PlanRegion region = plan_region(polygons, context);
  const Tin expected = clip(terrain, region, Side::inside, context).tin;
  for (const std::uint64_t seed : {1, 2, 3})
    EXPECT_EQ(clip(canonical(support::shuffled(terrain, seed)), region, Side::inside, context).tin, expected);
}

}  // namespace
}  // namespace terrane
