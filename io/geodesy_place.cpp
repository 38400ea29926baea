// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/UTMUPS.hpp>

#include "core/error.hpp"
#include "io/geodesy_osr.hpp"

// Where tiles lie on the globe: beside each other in longitude, and in which CRS they would be at home.
namespace terrane {

namespace {

constexpr double slack = 1e-9;  // degrees; rounding at +-180

/// The multiple of 360 that brings a box within [-180, 180], or its middle there when it crosses the antimeridian.
double homing_shift(const Box& box) {
  if (box.xmin >= -180 - slack && box.xmax <= 180 + slack) return 0;
  const double down = -360 * std::floor((box.xmin + 180 + slack) / 360);
  if (box.xmax + down <= 180 + slack) return down;
  const double middle = box.xmin + (box.xmax - box.xmin) / 2;
  return middle > -180 && middle <= 180 ? 0 : -360 * std::ceil((middle - 180) / 360);
}

struct Span {
  double low, high;
  std::size_t box;
};

}  // namespace

std::vector<double> unwrap_longitudes(const std::vector<Box>& boxes) {
  std::vector<double> shifts(boxes.size(), 0.0);
  std::vector<Span> spans;
  double widest = 0;
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    const Box& box = boxes[k];
    if (!(box.xmin <= box.xmax) || !std::isfinite(box.xmin) || !std::isfinite(box.xmax)) continue;  // empty
    shifts[k] = homing_shift(box);
    spans.push_back({box.xmin + shifts[k], box.xmax + shifts[k], k});
    widest = std::max(widest, box.xmax - box.xmin);
  }
  if (spans.empty() || widest >= 360) return shifts;
  std::sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) {
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.box < b.box;
  });
  double high = spans.front().high;
  std::size_t cut = 0;  // the first box after the widest gap
  double gap = -1;
  for (std::size_t k = 1; k < spans.size(); ++k) {
    if (spans[k].low - high > gap) {
      gap = spans[k].low - high;
      cut = k;
    }
    high = std::max(high, spans[k].high);
  }
  // Only tiles that meet across the antimeridian, or nearly so, are worth leaving [-180, 180] for.
  const double across = spans.front().low + 360 - high;
  if (cut == 0 || gap <= across || across > widest) return shifts;
  // The smaller half moves: west of the cut goes east, or east of it goes west.
  const bool move_west = cut <= spans.size() - cut;
  for (std::size_t k = 0; k < spans.size(); ++k) {
    if (move_west && k < cut) shifts[spans[k].box] += 360;
    if (!move_west && k >= cut) shifts[spans[k].box] -= 360;
  }
  return shifts;
}

std::vector<Point2> places_around(const Crs& crs, Point2 from, const std::vector<Point2>& offsets) {
  const Crs::Impl& impl = crs.inside();
  const GeographicLib::Geodesic geodesic(impl.semi_major,
                                         impl.inverse_flattening == 0 ? 0 : 1 / impl.inverse_flattening);
  double farthest = 0;
  for (const Point2 o : offsets) farthest = std::max(farthest, std::hypot(o.x, o.y));
  constexpr double metres_per_degree = 110'000;  // at least, along a meridian
  if (!(std::fabs(from.y) + farthest / metres_per_degree < 90) || !(std::fabs(from.x) <= 540))
    throw Error(ErrorKind::usage, "outside-crs",
                "what lies around that centre reaches a pole, or the centre is no longitude and latitude");
  std::vector<Point2> places;
  for (const Point2 o : offsets) {
    double latitude, longitude;
    geodesic.Direct(from.y, from.x, std::atan2(o.x, o.y) * 180 / 3.14159265358979323846, std::hypot(o.x, o.y), latitude,
                    longitude);
    places.push_back({longitude + 360 * std::round((from.x - longitude) / 360), latitude});
  }
  return places;
}

namespace {

bool every_datum_contains(const std::vector<Crs>& crs, std::string_view text) {
  return std::all_of(crs.begin(), crs.end(), [&](const Crs& c) {
    return !c.known() || c.local() || c.inside().horizontal_wkt.find(text) != std::string::npos;
  });
}

std::string utm_code(int zone, bool north, const std::vector<Crs>& crs) {
  const auto two = [](int number) { return (number < 10 ? "0" : "") + std::to_string(number); };
  if (north && zone >= 28 && zone <= 38 && every_datum_contains(crs, "European Terrestrial Reference System 1989"))
    return "EPSG:258" + two(zone);
  if (north && zone >= 1 && zone <= 23 && every_datum_contains(crs, "North American Datum 1983"))
    return "EPSG:269" + two(zone);
  return (north ? "EPSG:326" : "EPSG:327") + two(zone);
}

std::string equal_area(double longitude, double latitude) {
  const Quiet quiet;
  OGRSpatialReference srs;
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  srs.SetProjCS("Lambert azimuthal equal-area around the data");
  srs.SetWellKnownGeogCS("WGS84");
  srs.SetLAEA(latitude, longitude, 0, 0);
  return Crs::Impl::of(std::move(srs), "")->wkt;
}

}  // namespace

Crs suggest_crs(const std::vector<Box>& boxes, const std::vector<Crs>& crs) {
  std::vector<Box> places;
  for (std::size_t k = 0; k < boxes.size() && k < crs.size(); ++k) {
    if (!crs[k].known() || crs[k].local() || !(boxes[k].xmin <= boxes[k].xmax)) continue;
    const Box place = lon_lat_box(crs[k], boxes[k]);
    if (std::fabs(place.ymin) <= 90 && std::fabs(place.ymax) <= 90) places.push_back(place);
  }
  if (places.empty())
    throw Error(ErrorKind::input, "no-crs",
                "no input has a place on the Earth, so no system can be proposed; give one with crs");
  const std::vector<double> shifts = unwrap_longitudes(places);
  Box all{INFINITY, INFINITY, -INFINITY, -INFINITY};
  for (std::size_t k = 0; k < places.size(); ++k) {
    all.xmin = std::min(all.xmin, places[k].xmin + shifts[k]);
    all.xmax = std::max(all.xmax, places[k].xmax + shifts[k]);
    all.ymin = std::min(all.ymin, places[k].ymin);
    all.ymax = std::max(all.ymax, places[k].ymax);
  }
  const double longitude = std::remainder(all.xmin + (all.xmax - all.xmin) / 2, 360),
               latitude = all.ymin + (all.ymax - all.ymin) / 2;
  const int zone = GeographicLib::UTMUPS::StandardZone(latitude, longitude);
  if (zone > 0) {
    const double middle = 6 * zone - 183;
    // A degree beyond the zone's 3 does no harm; tiles at its edge should not fall out of it.
    const double west = std::remainder(all.xmin - middle, 360), east = std::remainder(all.xmax - middle, 360);
    if (all.xmax - all.xmin < 8 && west >= -4 && east <= 4) return Crs::parse(utm_code(zone, latitude >= 0, crs));
  }
  return Crs::parse(equal_area(std::round(longitude), std::round(latitude)));
}

}  // namespace terrane
