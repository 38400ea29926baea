// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/volume.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/volume/area_weights.hpp"
#include "core/volume/volume_sum.hpp"
#include "support/exact.hpp"
#include "support/terrains.hpp"

namespace terrane {
namespace {

const Box unit = {0, 0, 1, 1};

// dz = x - c over the triangle (0,0) (1,0) (0,1), where the chord at x has the length 1 - x.
struct Ramp {
  double c;
  double volume(double from, double to) const {  // integral of (x - c)(1 - x)
    const auto f = [&](double x) { return (1 + c) * x * x / 2 - x * x * x / 3 - c * x; };
    return f(to) - f(from);
  }
  double area(double from, double to) const { return (to - to * to / 2) - (from - from * from / 2); }
};

TEST(VolumeSum, CutsAFaceWhereItPassesTheReference) {
  for (const double c : {0.0, 0.001, 0.25, 0.5, 0.999, 1.0}) {
    const AreaWeights weights({}, unit);
    VolumeSum sum(weights, 0);
    sum.add({{{0, 0}, {1, 0}, {0, 1}}}, {10 - c, 11 - c, 10 - c}, {10, 10, 10});
    const Volume v = sum.result();
    const Ramp ramp{c};
    EXPECT_NEAR(v.fill.volume, ramp.volume(c, 1), 1e-14);
    EXPECT_NEAR(v.cut.volume, -ramp.volume(0, c), 1e-14);
    EXPECT_NEAR(v.fill.area_2d, ramp.area(c, 1), 1e-14);
    EXPECT_NEAR(v.cut.area_2d, ramp.area(0, c), 1e-14);
    EXPECT_NEAR(v.fill.area_3d, std::sqrt(2.0) * ramp.area(c, 1), 1e-14);
    EXPECT_NEAR(v.fill.max_dz, 1 - c, 1e-14);
    EXPECT_NEAR(v.cut.max_dz, c, 1e-14);
    EXPECT_EQ(v.same_area_2d, 0);
    EXPECT_EQ(v.overlap_area_2d, 0.5);
    EXPECT_LT(v.identity_residual, 1e-14);
    EXPECT_NEAR(v.net, 1.0 / 6 - c / 2, 1e-14);
  }
}

TEST(VolumeSum, ToleranceSetsABandApart) {
  const double t = 0.125;
  for (const double c : {0.0, 0.0625, 0.125, 0.4, 0.95}) {
    const AreaWeights weights({}, unit);
    VolumeSum sum(weights, t);
    sum.add({{{0, 0}, {1, 0}, {0, 1}}}, {-c, 1 - c, -c}, {0, 0, 0});
    const Volume v = sum.result();
    const Ramp ramp{c};
    const double low = std::max(0.0, c - t), high = std::min(1.0, c + t);
    EXPECT_NEAR(v.fill.volume, ramp.volume(high, 1), 1e-14);
    EXPECT_NEAR(v.cut.volume, -ramp.volume(0, low), 1e-14);
    EXPECT_NEAR(v.same_area_2d, ramp.area(low, high), 1e-14);
    EXPECT_NEAR(v.same_area_3d, std::sqrt(2.0) * ramp.area(low, high), 1e-14);
    EXPECT_NEAR(v.fill.area_2d + v.cut.area_2d + v.same_area_2d, 0.5, 1e-14);
    EXPECT_EQ(v.net, v.fill.volume - v.cut.volume);
  }
}

TEST(VolumeSum, EqualSurfacesAreTheSame) {
  const AreaWeights weights({}, unit);
  VolumeSum sum(weights, 0);
  sum.add({{{0, 0}, {1, 0}, {0, 1}}}, {1, 2, 3}, {1, 2, 3});
  const Volume v = sum.result();
  EXPECT_EQ(v.same_area_2d, 0.5);
  EXPECT_EQ(v.fill.volume + v.cut.volume + v.fill.area_2d + v.cut.area_2d, 0);
}

TEST(VolumeSum, SidesAddUpOnRandomFaces) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> plane(0, 1), height(-1, 1);
  for (const double tolerance : {0.0, 0.2}) {
    const AreaWeights weights({}, unit);
    VolumeSum sum(weights, tolerance);
    for (int i = 0; i < 1000; ++i) {
      std::array<Point2, 3> p;
      for (Point2& q : p) q = {plane(random), plane(random)};
      // Heights on the level itself are a case of their own.
      const auto z = [&] { return random() % 4 ? height(random) : tolerance; };
      sum.add(p, {z(), z(), z()}, {0, 0, 0});
    }
    const Volume v = sum.result();
    EXPECT_NEAR(v.fill.area_2d + v.cut.area_2d + v.same_area_2d, v.overlap_area_2d, 1e-11);
    EXPECT_LT(v.identity_residual, 1e-11);
  }
}

/// Two triangles over [0, w] x [south, south + h].
Tin sheet(double south, double w, double h, double z_south, double z_north) {
  return {{{0, south, z_south}, {w, south, z_south}, {w, south + h, z_north}, {0, south + h, z_north}},
          {{0, 1, 2}, {0, 2, 3}}};
}

// The sphere in radians: the scale of longitude and latitude is cos(y).
TEST(AreaScale, IntegratesASphereToNineDigits) {
  const AreaScale sphere = [](double, double y) { return std::cos(y); };
  for (const double h : {1e-6, 1e-4, 0.01, 0.1, 0.7, 1.5})
    for (const double south : {0.0, 0.05}) {
      const Tin tin = sheet(south, h / 2, h, 3, 3 + h);
      const double north = south + h;
      const double sine =
          2 * std::cos(south + h / 2) * std::sin(h / 2);  // sin(north) - sin(south) without cancellation
      EXPECT_NEAR(area(tin, sphere) / (h / 2 * sine), 1, 1e-9) << h;
      if (h < 0.01) continue;  // the closed form below cancels
      const auto f = [&](double y) { return (3 - south + y) * std::sin(y) + std::cos(y); };
      EXPECT_NEAR(integral(tin, sphere) / (h / 2 * (f(north) - f(south))), 1, 1e-9) << h;
    }
}

TEST(AreaScale, WeighsBothSidesOfACut) {
  const AreaScale sphere = [](double, double y) { return std::cos(y); };
  const double h = 0.6, level = 3 + h / 3;
  Context context;
  const Volume v = volume(sheet(0, 1, h, 3, 3 + h), level, 0, sphere, context);
  EXPECT_NEAR(v.fill.area_2d / (std::sin(h) - std::sin(h / 3)), 1, 1e-9);
  EXPECT_NEAR(v.cut.area_2d / std::sin(h / 3), 1, 1e-9);
  EXPECT_NEAR(v.cut.volume / (1 - std::cos(h / 3)), 1, 1e-9);  // integral of (h/3 - y) cos y
  EXPECT_LT(v.identity_residual, 1e-9 * v.fill.volume);
}

TEST(ScaleSheet, StandsInForASmoothScaleAndOnlyForOne) {
  const Box box = {-1, 0.2, 1, 1.2};
  int asked = 0;
  const ScaleSheet smooth([&](double x, double y) { return ++asked, std::cos(y) / (3 + x); }, box);
  EXPECT_FALSE(smooth.exact());
  const int before = asked;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 1000; ++i) {
    const double x = -1 + 2 * u(random), y = 0.2 + u(random);
    EXPECT_NEAR(smooth({x, y}) * (3 + x) / std::cos(y), 1, 1e-10);
  }
  EXPECT_EQ(asked, before);
  EXPECT_TRUE(ScaleSheet([](double x, double) { return x < 0.123 ? 1.0 : 2.0; }, box).exact());
  EXPECT_TRUE(ScaleSheet([](double, double) { return NAN; }, box).exact());
}

TEST(VolumeAgainstALevel, AgreesWithTheIntegral) {
  Context context;
  const Tin tin = sheet(0, 7, 3, 1, 4);
  const Volume v = volume(tin, 2.0, 0, {}, context);
  EXPECT_NEAR(v.net, integral(tin, {}) - 2 * area(tin, {}), 1e-12);
  EXPECT_NEAR(v.fill.volume, 7 * 2.0, 1e-12);
  EXPECT_NEAR(v.cut.volume, 7 * 0.5, 1e-12);
  EXPECT_EQ(v.surface_only_area_2d, 0);
  EXPECT_EQ(v.overlap_area_2d, 21);
}

TEST(VolumeOfTwoSurfaces, CountsWhatOnlyOneHas) {
  Context context;
  const Tin tin = sheet(0, 4, 4, 2, 2), shifted = sheet(1, 3, 5, 1, 1);
  const Volume v = volume(tin, shifted, 0, {}, context);
  EXPECT_NEAR(v.overlap_area_2d, 9, 1e-12);
  EXPECT_NEAR(v.surface_only_area_2d, 7, 1e-12);
  EXPECT_NEAR(v.reference_only_area_2d, 6, 1e-12);
  EXPECT_NEAR(v.net, 9, 1e-12);
  const Volume back = volume(shifted, tin, 0, {}, context);
  EXPECT_EQ(back.cut.volume, v.fill.volume);
  EXPECT_EQ(back.net, -v.net);
}

TEST(VolumeOfTwoSurfaces, IsAccurateOnAFaceThatIsNearlyALine) {
  // Collinear but for the last bits: plain doubles make half of its area of nothing.
  const Tin low{
      {{329.13582509016038, 30.100613181524018, 0}, {500, 500, 0}, {670.86417490983945, 969.89938681847605, 0}},
      {{0, 1, 2}}};
  Tin high = low;
  for (Point& p : high.vertices) p.z = 1;
  const double area =
      0.5 * support::area2_exact(plan(low.vertices[0]), plan(low.vertices[1]), plan(low.vertices[2])).get_d();
  ASSERT_GT(area, 0);
  Context context;
  const Volume v = volume(high, low, 0, {}, context);
  EXPECT_NEAR(v.fill.volume, area, 1e-12 * area);
  EXPECT_NEAR(v.overlap_area_2d, area, 1e-12 * area);
}

void expect_near(const VolumeSide& a, const VolumeSide& b) {
  EXPECT_NEAR(a.volume, b.volume, 1e-12 * b.volume);
  EXPECT_NEAR(a.area_2d, b.area_2d, 1e-12 * b.area_2d);
  EXPECT_NEAR(a.area_3d, b.area_3d, 1e-12 * b.area_3d);
  EXPECT_EQ(a.max_dz, b.max_dz);
}

TEST(Volumes, AtManyLevelsAreThoseAtEach) {
  const Tin tin = support::patch(0, 0, 12, 12, 3, 5);
  std::vector<double> levels = {7, -1e4, 0.5, 1e4, 0.5, tin.vertices[7].z, tin.vertices[30].z};
  for (int i = -60; i < 60; ++i) levels.push_back(0.37 * i);
  Context context;
  for (const double tolerance : {0.0, 0.2, 5.0}) {
    const std::vector<Volume> all = volumes(tin, levels, tolerance, {}, context);
    ASSERT_EQ(all.size(), levels.size());
    for (std::size_t i = 0; i < levels.size(); ++i) {
      const Volume one = volume(tin, levels[i], tolerance, {}, context);
      expect_near(all[i].fill, one.fill);
      expect_near(all[i].cut, one.cut);
      EXPECT_NEAR(all[i].same_area_2d, one.same_area_2d, 1e-12 * one.overlap_area_2d);
      EXPECT_NEAR(all[i].same_area_3d, one.same_area_3d, 1e-12 * one.overlap_area_2d);
      EXPECT_NEAR(all[i].overlap_area_2d, one.overlap_area_2d, 1e-12 * one.overlap_area_2d);
      EXPECT_LE(all[i].identity_residual, 1e-12 * (one.fill.volume + one.cut.volume));
    }
  }
}

TEST(Volumes, AFaceIsMeasuredWhereItPassesALevelAndNotAtEachLevel) {
  // A scale that no series fits is asked for every piece that is measured.
  std::size_t asked = 0;
  const AreaScale scale = [&](double x, double y) {
    ++asked;
    return 1 + 1e-9 * std::sin(1e7 * x + 1e6 * y);
  };
  Tin tin;
  for (int i = 0; i <= 2000; ++i) tin.vertices.push_back({i / 2.0, i % 2 * 1.0, i / 20.0});
  for (int i = 0; i + 2 <= 2000; ++i) tin.faces.push_back(i % 2 ? Face{i, i + 1, i + 2} : Face{i, i + 2, i + 1});
  Context context;
  std::vector<double> levels(1, -1);
  volumes(tin, levels, 0, scale, context);
  const std::size_t once = asked;
  for (int i = 0; i < 1000; ++i) levels.push_back(0.1 * i);
  asked = 0;
  volumes(tin, levels, 0, scale, context);
  EXPECT_LT(asked, 10 * once);
}

}  // namespace
}  // namespace terrane
