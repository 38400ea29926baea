// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge/blend.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/error.hpp"
#include "core/merge/bisected_mesh.hpp"
#include "support/checks.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

using support::Sampler;
using support::wrong_with;

struct Judged {
  Tin tin;  // by place, where all faces agree
  double worst = 0, jump = 0;
};

Blended blended(const Tin& a, const Tin& b, double width, double tolerance) {
  Context context;
  return blend(overlay(a, b, {}, context), {width, BlendSide::both, tolerance, {1, 1}}, context);
}

double height(const Blended& b, std::size_t f, int k) {
  const double w = b.weight[3 * f + k];
  const auto face = static_cast<Index>(f);
  return w == 1   ? b.overlay.height(0, face, k)
         : w == 0 ? b.overlay.height(1, face, k)
                  : w * b.overlay.height(0, face, k) + (1 - w) * b.overlay.height(1, face, k);
}

/// Distance to the sides given of a rectangle's border: x = value or y = value between two ends.
double distance(Point2 p, Point2 a, Point2 b) {
  const double ux = b.x - a.x, uy = b.y - a.y;
  const double t = std::clamp(((p.x - a.x) * ux + (p.y - a.y) * uy) / (ux * ux + uy * uy), 0.0, 1.0);
  return std::hypot(p.x - a.x - t * ux, p.y - a.y - t * uy);
}

Tin plan_of(const Blended& b) {
  Tin tin;
  for (const Point2 p : b.overlay.points) tin.vertices.push_back({p.x, p.y, 0});
  tin.faces.assign(b.overlay.faces.begin(), b.overlay.faces.end());
  return canonical(tin);
}

TEST(Blend, IsTheWeightedMeanEverywhere) {
  const Tin a = support::patch(0, 0, 10, 10, 10), b = support::patch(60, -4, 12, 12, 9.25, 7);
  const Blended made = blended(a, b, 20, 1e-3);
  EXPECT_EQ(wrong_with(plan_of(made)), "");
  EXPECT_LE(made.report.bound, 1e-3);
  Tin surface;
  for (std::size_t f = 0; f < made.overlay.faces.size(); ++f) {
    Face face;
    for (int k = 0; k < 3; ++k) {
      const Point2 p = made.overlay.points[made.overlay.faces[f][k]];
      face[k] = static_cast<Index>(surface.vertices.size());
      surface.vertices.push_back({p.x, p.y, height(made, f, k)});
    }
    surface.faces.push_back(face);
  }
  const Sampler za(a), zb(b), z(surface);
  for (const Point2 p : support::random_places({60.1, 0.1, 99.9, 99.9}, 5000, 4)) {
    if (std::min(std::hypot(p.x - 60, p.y), std::hypot(p.x - 60, p.y - 100)) < made.report.radius) continue;
    const double da = std::min({100 - p.x, p.y, 100 - p.y}), db = p.x - 60,
                 w = std::min(1.0, da / std::min(20.0, da + db));
    EXPECT_NEAR(z(p), w * za(p) + (1 - w) * zb(p), 1e-3 + 1e-9);
  }
}

TEST(Blend, ANarrowOverlapFadesFromOneBorderToTheOther) {
  const Tin a = support::patch(0, 0, 10, 10, 10), b = support::patch(90, 0, 10, 10, 10, 7);
  const Blended made = blended(a, b, 50, 1e-3);
  for (std::size_t f = 0; f < made.overlay.faces.size(); ++f)
    for (int k = 0; k < 3; ++k)
      if (made.overlay.parents[f][0] != none && made.overlay.parents[f][1] != none) {
        EXPECT_NEAR(made.weight[3 * f + k], (100 - made.overlay.points[made.overlay.faces[f][k]].x) / 10, 1e-12);
      }
}

TEST(Blend, WithinTheToleranceWhereBordersMeet) {
  const Tin a = support::patch(0, 0, 8, 8, 12.5), b = support::patch(60, 60, 9, 9, 11.1, 5);
  for (const double tolerance : {0.1, 0.01}) {
    const Blended made = blended(a, b, 15, tolerance);
    EXPECT_EQ(wrong_with(plan_of(made)), "");
    EXPECT_LE(made.report.bound, tolerance);
    EXPECT_EQ(made.report.corners, 2);
    double worst = 0;
    const Sampler za(a), zb(b);
    for (std::size_t f = 0; f < made.overlay.faces.size(); ++f) {
      if (made.overlay.parents[f][0] == none || made.overlay.parents[f][1] == none) continue;
      Point2 c;
      double z = 0;
      for (int k = 0; k < 3; ++k) {
        const Point2 p = made.overlay.points[made.overlay.faces[f][k]];
        c.x += p.x / 3, c.y += p.y / 3, z += height(made, f, k) / 3;
      }
      if (std::min(std::hypot(c.x - 100, c.y - 60), std::hypot(c.x - 60, c.y - 100)) < 2 * made.report.radius) continue;
      const double da = std::min(distance(c, {100, 60}, {100, 100}), distance(c, {60, 100}, {100, 100}));
      const double db = std::min(distance(c, {60, 60}, {100, 60}), distance(c, {60, 60}, {60, 100}));
      const double w = std::min(1.0, da / std::min(15.0, da + db));
      worst = std::max(worst, std::fabs(z - w * za(c) - (1 - w) * zb(c)));
    }
    EXPECT_LE(worst, tolerance);
    EXPECT_GT(worst, tolerance / 50);
    std::printf("tolerance %g: %zu faces, %d made, bound %g, measured %g\n", tolerance, made.overlay.faces.size(),
                made.report.made, made.report.bound, worst);
  }
}

TEST(Blend, ATileInsideAnotherHoldsInItsMiddle) {
  const Tin survey = support::patch(40, 40, 10, 10, 2, 3), dem = support::patch(0, 0, 10, 10, 10);
  const Blended made = blended(survey, dem, 5, 0.01);
  EXPECT_EQ(made.report.corners, 0);
  for (std::size_t f = 0; f < made.overlay.faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const Point2 p = made.overlay.points[made.overlay.faces[f][k]];
      const double d = std::min({p.x - 40, 60 - p.x, p.y - 40, 60 - p.y});
      EXPECT_NEAR(made.weight[3 * f + k], std::clamp(d / 5, 0.0, 1.0), 1e-12);
    }
}

/// A square whose faces bend, refined with up to `most` vertices.
struct Bisection {
  Index made = 0;
  std::string refusal;
};
Bisection bisected(double tolerance, Index most) {
  const Array<Point2> points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const Array<Face> faces = {{0, 1, 2}, {0, 2, 3}};
  BisectedMesh mesh(points, faces, {std::vector<double>(6, 0), std::vector<double>(6, 0)}, {1, 1});
  Bisection result;
  Context context;
  const auto error = [&](Index f) { return std::pow(mesh.longest_edge(f), 2); };
  try {
    mesh.refine({error, tolerance, [](Index) { return true; }, [](Index, Index, Index, Index, Index) {}, most},
                context);
  } catch (const Error& refused) {
    EXPECT_EQ(refused.code, "blend-tolerance");
    result.refusal = refused.what();
  }
  result.made = mesh.made();
  return result;
}

TEST(Blend, WhatWouldTakeTooManyVerticesIsRefusedAtOnceAndWhatFitsIsNot) {
  for (const double tolerance : {1e-4, 1e-5, 3e-6}) {
    const Index needed = bisected(tolerance, 8'000'000).made;
    EXPECT_EQ(bisected(tolerance, needed).made, needed);
    for (const Index part : {8, 32, 128}) {
      const Bisection refused = bisected(tolerance, needed / part);
      EXPECT_NE(refused.refusal, "") << needed << " / " << part;
      EXPECT_LT(refused.made, 2 * needed / part / part) << needed << " / " << part;
    }
  }
  const Tin a = support::patch(0, 0, 10, 10, 10), b = support::patch(60, 60, 10, 10, 10, 7);
  try {
    blended(a, b, 15, 1e-300);
    ADD_FAILURE() << "not refused";
  } catch (const Error& refused) {
    EXPECT_NE(std::string(refused.what()).find("needs about 1000000000000000 new vertices"), std::string::npos);
  }
}

TEST(Blend, EqualSurfacesNeedNoRefinement) {
  const Tin a = support::patch(0, 0, 10, 10, 10), b = support::patch(60, 60, 10, 10, 10);
  const Blended made = blended(a, b, 15, 0.01);
  EXPECT_EQ(made.report.made, 0);
}

}  // namespace
}  // namespace terrane
