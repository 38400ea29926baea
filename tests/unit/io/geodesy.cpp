// SPDX-License-Identifier: GPL-3.0-or-later

#include <GeographicLib/PolygonArea.hpp>
#include <GeographicLib/TransverseMercator.hpp>

#include "unit/io/reading.hpp"

namespace terrane {
namespace {

Point moved(Point point, const char* from, const char* to) {
  std::vector<Point> points = {point};
  transform_points(points, Crs::parse(from), Crs::parse(to));
  return points[0];
}

std::string code_of_failure(const char* from, const char* to) {
  try {
    moved({-100, 39.5, 100}, from, to);
  } catch (const Error& error) {
    return error.code + ": " + error.what();
  }
  return "";
}

TEST(Transform, LongitudeComesFirst) {
  // GeographicLib computes UTM on its own.
  double x = 0, y = 0;
  GeographicLib::TransverseMercator::UTM().Forward(3, 39.5, 2.5, x, y);
  const Point utm = moved({2.5, 39.5, 100}, "EPSG:4326", "EPSG:32631");
  EXPECT_NEAR(utm.x, x + 500'000, 1e-6);
  EXPECT_NEAR(utm.y, y, 1e-6);
  EXPECT_EQ(utm.z, 100);
  const Point back = moved(utm, "EPSG:32631", "EPSG:4326");
  EXPECT_NEAR(back.x, 2.5, 1e-11);
  EXPECT_NEAR(back.y, 39.5, 1e-11);
}

TEST(Transform, KnownValues) {
  // The worked examples of the EPSG guidance note 7-2.
  const Point tm = moved({0.5, 50.5, 0}, "EPSG:4277", "EPSG:27700");
  EXPECT_NEAR(tm.x, 577274.99, 0.01);
  EXPECT_NEAR(tm.y, 69740.50, 0.01);
  const Point lcc = moved({-96, 28.5, 0}, "EPSG:4267", "EPSG:32040");
  EXPECT_NEAR(lcc.x, 2963503.91, 0.01);
  EXPECT_NEAR(lcc.y, 254759.80, 0.01);
}

TEST(Transform, GeoidHeightsShift) {
  // EGM96's undulation at 38.6281550 N, 269.7791550 E as in the test values of its own program (metres).
  const Point p = moved({269.7791550 - 360, 38.6281550, 0}, "EPSG:4979", "EPSG:4326+5773");
  EXPECT_NEAR(p.z, 31.628, 0.3);  // on the 15' grid
  EXPECT_EQ(p.x, 269.7791550 - 360);
  EXPECT_EQ(p.y, 38.6281550);
  EXPECT_NEAR(moved(p, "EPSG:4326+5773", "EPSG:4979").z, 0, 1e-3);
}

TEST(Transform, HeightsAreNeverSilentlyUnshifted) {
  for (const char* target : {"EPSG:4326+5703", "EPSG:4326+3855", "EPSG:6318+5703"}) {
    const std::string failure = code_of_failure("EPSG:4979", target);
    EXPECT_EQ(failure.find("missing-grid"), 0u) << target << " " << failure;
    EXPECT_TRUE(failure.find(".tif") != std::string::npos || failure.find(".gtx") != std::string::npos) << failure;
  }
}

TEST(Transform, HeightsStayWhereOneDatumIsUnknown) {
  EXPECT_EQ(moved({2.5, 39.5, 100}, "EPSG:4326+5773", "EPSG:25831").z, 100);
  EXPECT_EQ(moved({2.5, 39.5, 100}, "EPSG:4326", "EPSG:25831+5773").z, 100);
  EXPECT_EQ(moved({2.5, 39.5, 100}, "EPSG:4326+5773", "EPSG:25831+5773").z, 100);
}

TEST(Transform, UnitsOfHeightsAreConverted) {
  EXPECT_DOUBLE_EQ(moved({-74, 40.7, 100}, "EPSG:4269+5703", "EPSG:2263+6360").z, 100 * 3937 / 1200.0);
  EXPECT_DOUBLE_EQ(moved({3, 4, 5}, "local:m", "local:ft").z, 5 / 0.3048);
  Tin tin{{{-74, 40.7, 100}, {-73.9, 40.7, 100}, {-74, 40.8, 100}}, {{0, 1, 2}}};
  Context context;
  transform(tin, Crs::parse("EPSG:4326"), Crs::parse("EPSG:2263"), nullptr, context);
  ASSERT_EQ(context.warnings.size(), 1u);
  EXPECT_EQ(context.warnings[0].code, "heights-converted");
}

TEST(Transform, SamePlanKeepsEveryBit) {
  Context context;
  double error = -1;
  const Tin tin = awkward_tin();
  expect_same_bits(transform(tin, Crs::parse("EPSG:4326"), Crs::parse("OGC:CRS84"), &error, context), tin);
  EXPECT_EQ(error, 0);
}

TEST(Transform, PlacesOutsideAreNamed) {
  Context context;
  const Tin tin{{{2, 39, 1}, {3, 39, 1}, {2, 95, 1}}, {{0, 1, 2}}};
  try {
    transform(tin, Crs::parse("EPSG:4326"), Crs::parse("EPSG:25831"), nullptr, context);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code, "outside-crs");
    EXPECT_NE(std::string(error.what()).find("vertex 2"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(std::isnan(moved({2, 95, 1}, "EPSG:4326", "EPSG:25831").x));
  EXPECT_THROW(moved({2, 39, 1}, "EPSG:4326", "local:m"), Error);
  EXPECT_THROW(moved({2, 39, 1}, "local:m", "EPSG:4326"), Error);
}

TEST(Transform, TellsHowMuchEdgesBend) {
  // A tilted degree square: its edges are straight in longitude and latitude, not in UTM.
  Tin tin{{{2, 39, 0}, {3, 39, 1000}, {3, 40, 0}, {2, 40, 500}}, {{0, 1, 2}, {0, 2, 3}}};
  Context context;
  double coarse = 0, fine = 0;
  const Crs degrees = Crs::parse("EPSG:4326"), utm = Crs::parse("EPSG:25831");
  transform(tin, degrees, utm, &coarse, context);
  // The southern edge's middle lies about 242 m off the chord, on the plane of face 0 1 2.
  const Point a = moved(tin.vertices[0], "EPSG:4326", "EPSG:25831"),
              b = moved(tin.vertices[1], "EPSG:4326", "EPSG:25831");
  const Point m = moved({2.5, 39, 500}, "EPSG:4326", "EPSG:25831");
  EXPECT_GT(std::fabs(m.y - (a.y + b.y) / 2), 100);
  EXPECT_GT(coarse, 0.1);
  EXPECT_LT(coarse, 20);
  for (Point& p : tin.vertices) p = {2 + (p.x - 2) / 10, 39 + (p.y - 39) / 10, p.z / 10};
  transform(tin, degrees, utm, &fine, context);
  EXPECT_LT(fine, coarse / 50);
}

TEST(Transform, SurfacesAcrossTheAntimeridianStayWhole) {
  Context context;
  const Tin tin{{{179.5, -17, 1}, {180.5, -17, 1}, {180, -16, 1}}, {{0, 1, 2}}};
  const Tin utm = transform(tin, Crs::parse("EPSG:4326"), Crs::parse("EPSG:32760"), nullptr, context);
  const Tin back = transform(utm, Crs::parse("EPSG:32760"), Crs::parse("EPSG:4326"), nullptr, context);
  for (int v = 0; v < 3; ++v) EXPECT_NEAR(back.vertices[v].x, tin.vertices[v].x, 1e-9);
}

TEST(Transform, OnePlaceAt180Degrees) {
  for (const char* crs : {"EPSG:3832", "EPSG:32760", "EPSG:32701"})
    for (const double longitude : {180., -180., 540.}) {
      const Point there = moved({longitude, -17, 0}, "OGC:CRS84", crs);
      const Point back = moved(there, crs, "OGC:CRS84");
      EXPECT_NEAR(std::fabs(back.x), 180, 1e-9) << crs << ", " << longitude;
      EXPECT_NEAR(back.y, -17, 1e-9) << crs << ", " << longitude;
    }
}

TEST(AreaScale, OfDegreesIsThatOfTheEllipsoid) {
  const AreaScale scale = ellipsoidal_area_scale(Crs::parse("EPSG:4326"));
  // Summed over one square degree: GeographicLib's geodesic polygon with the parallels cut fine.
  GeographicLib::PolygonArea polygon(GeographicLib::Geodesic::WGS84());
  constexpr int n = 2000;
  for (int k = 0; k <= n; ++k) polygon.AddPoint(39, 2 + static_cast<double>(k) / n);
  for (int k = 0; k <= n; ++k) polygon.AddPoint(40, 3 - static_cast<double>(k) / n);
  double perimeter = 0, area = 0, sum = 0;
  polygon.Compute(false, true, perimeter, area);
  for (int k = 0; k < n; ++k) sum += scale(2.5, 39 + (k + 0.5) / n) / n;
  EXPECT_NEAR(sum / area, 1, 1e-8);
  EXPECT_THROW(scale(500'000, 4'400'000), Error);
}

TEST(AreaScale, OfUtmIsTheSquareOfItsPointScale) {
  const Crs crs = Crs::parse("EPSG:32631");
  const AreaScale scale = ellipsoidal_area_scale(crs);
  double worst = 0;
  for (double longitude = -1; longitude <= 7; longitude += 0.37)
    for (double latitude = -79; latitude <= 83; latitude += 5.3) {
      double x = 0, y = 0, convergence = 0, k = 0;
      GeographicLib::TransverseMercator::UTM().Forward(3, latitude, longitude, x, y, convergence, k);
      worst = std::max(worst, std::fabs(scale(x + 500'000, y) * k * k - 1));
    }
  EXPECT_LT(worst, 1e-9);
  EXPECT_NEAR(scale_factor(crs, {500'000, 4'400'000}), 0.9996, 1e-9);
}

TEST(AreaScale, OfEqualAreaProjectionsIsOne) {
  for (const char* id : {"EPSG:3035", "EPSG:6933", "EPSG:5070"}) {
    const Crs crs = Crs::parse(id);
    const AreaScale scale = ellipsoidal_area_scale(crs);
    const Point centre = moved({std::string(id) == "EPSG:5070" ? -96.0 : 12.0, 48, 0}, "EPSG:4326", id);
    for (double dx : {-731'234.5, 0.0, 1'234'567.0})
      for (double dy : {-456'789.0, 0.0, 987'654.0}) EXPECT_NEAR(scale(centre.x + dx, centre.y + dy), 1, 1e-7) << id;
  }
}

TEST(AreaScale, WorksInFeetAndAtThePole) {
  const double foot = 1200.0 / 3937;
  EXPECT_NEAR(ellipsoidal_area_scale(Crs::parse("EPSG:2263"))(984250, 194305) / (foot * foot), 1, 1e-4);
  EXPECT_DOUBLE_EQ(grid_area_scale(Crs::parse("EPSG:2263"))(984250, 194305), foot * foot);
  EXPECT_DOUBLE_EQ(ellipsoidal_area_scale(Crs::parse("local:ft"))(1, 2), 0.3048 * 0.3048);
  // UPS has the scale 0.994 at the pole itself.
  EXPECT_NEAR(ellipsoidal_area_scale(Crs::parse("EPSG:32661"))(2'000'000, 2'000'000) * 0.994 * 0.994, 1, 1e-7);
  EXPECT_THROW(ellipsoidal_area_scale(Crs::parse("EPSG:3035"))(1e12, 0), Error);
  EXPECT_THROW(ellipsoidal_area_scale(Crs::parse("EPSG:3035"))(NAN, 0), Error);
}

TEST(AreaScale, IsContinuousAcrossItsNodes) {
  const AreaScale scale = ellipsoidal_area_scale(Crs::parse("EPSG:25831"));
  for (int k = 1; k < 40; ++k)
    EXPECT_NEAR(scale(25'000.0 * k - 1e-6, 4'412'345), scale(25'000.0 * k + 1e-6, 4'412'345), 1e-12);
}

using Shifts = std::vector<double>;

TEST(Longitudes, TilesComeToLieBesideEachOther) {
  EXPECT_EQ(unwrap_longitudes({{354, 0, 360, 1}, {0, 0, 6, 1}}), (Shifts{-360, 0}));
  EXPECT_EQ(unwrap_longitudes({{354, 0, 360, 1}, {-3, 0, 6, 1}}), (Shifts{-360, 0}));
  EXPECT_EQ(unwrap_longitudes({{170, 0, 180, 1}, {-180, 0, -170, 1}}), (Shifts{0, 360})) << "one whole from 170 to 190";
  EXPECT_EQ(unwrap_longitudes({{-180, 0, -170, 1}, {170, 0, 180, 1}}), (Shifts{360, 0}));
  EXPECT_EQ(unwrap_longitudes({{170, 0, 180, 1}, {180, 0, 190, 1}}), (Shifts{0, 0})) << "already beside each other";
  EXPECT_EQ(unwrap_longitudes({{190, 0, 200, 1}}), (Shifts{-360}));
  EXPECT_EQ(unwrap_longitudes({{175, 0, 185, 1}}), (Shifts{0}));
  EXPECT_EQ(unwrap_longitudes({{0, 0, 360, 1}}), (Shifts{0}));
  EXPECT_EQ(unwrap_longitudes({{-100, 0, -90, 1}, {100, 0, 110, 1}}), (Shifts{0, 0}));
  EXPECT_EQ(unwrap_longitudes({{-730, 0, -725, 1}, {HUGE_VAL, 0, -HUGE_VAL, 0}}), (Shifts{720, 0}));
  EXPECT_EQ(unwrap_longitudes({}), Shifts{});
}

TEST(Suggestion, IsAZoneOrEqualArea) {
  const Crs wgs = Crs::parse("EPSG:4326"), etrs = Crs::parse("EPSG:4258"), nad = Crs::parse("EPSG:4269");
  EXPECT_EQ(suggest_crs({{1, 39, 3, 40}}, {wgs}).id(), "EPSG:32631");
  EXPECT_EQ(
      suggest_crs({{1, 39, 3, 40}, {400'000, 4'300'000, 500'000, 4'400'000}}, {etrs, Crs::parse("EPSG:25831")}).id(),
      "EPSG:25831");
  EXPECT_EQ(
      suggest_crs({{1, 39, 3, 40}, {400'000, 4'300'000, 500'000, 4'400'000}}, {wgs, Crs::parse("EPSG:25831")}).id(),
      "EPSG:32631");
  EXPECT_EQ(suggest_crs({{-79, 35, -78, 36}}, {nad}).id(), "EPSG:26917");
  EXPECT_EQ(suggest_crs({{-71, -33, -70, -32}}, {wgs}).id(), "EPSG:32719");
  EXPECT_EQ(suggest_crs({{179, -18, 180, -17}, {-180, -18, -179, -17}}, {wgs, wgs}).id(), "EPSG:32701");
  const Crs wide = suggest_crs({{1, 39, 3, 40}, {20, 50, 22, 51}}, {wgs, wgs});
  EXPECT_NE(wide.wkt().find("Lambert Azimuthal Equal Area"), std::string::npos) << wide.wkt();
  EXPECT_NEAR(ellipsoidal_area_scale(wide)(10'000, -20'000), 1, 1e-8);
  EXPECT_THROW(suggest_crs({{0, 0, 1, 1}}, {Crs::parse("local:m")}), Error);
}

}  // namespace
}  // namespace terrane
