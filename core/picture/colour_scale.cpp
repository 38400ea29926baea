// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/picture/colour_scale.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace terrane {

namespace {

struct RampStop {
  double at;
  Colour colour;
};

constexpr RampStop atlas_land[] = {{0.00, {0.52, 0.66, 0.51}}, {0.12, {0.66, 0.76, 0.57}}, {0.30, {0.87, 0.86, 0.66}},
                                   {0.50, {0.86, 0.75, 0.55}}, {0.70, {0.74, 0.61, 0.48}}, {0.88, {0.80, 0.75, 0.71}},
                                   {1.00, {0.97, 0.97, 0.97}}};
constexpr RampStop atlas_sea[] = {
    {0.00, {0.74, 0.86, 0.93}}, {0.15, {0.60, 0.78, 0.90}}, {0.50, {0.40, 0.62, 0.81}}, {1.00, {0.22, 0.42, 0.65}}};

// From the sea's level up, and from the deep up to the shore.
constexpr Colour land[] = {{0.16, 0.42, 0.28}, {0.36, 0.56, 0.29}, {0.62, 0.67, 0.34},
                           {0.84, 0.77, 0.48}, {0.93, 0.86, 0.72}, {0.99, 0.98, 0.96}};
constexpr Colour sea[] = {
    {0.04, 0.10, 0.27}, {0.08, 0.25, 0.48}, {0.22, 0.47, 0.69}, {0.52, 0.73, 0.85}, {0.80, 0.90, 0.94}};
constexpr Colour cut[] = {
    {0.97, 0.97, 0.96}, {0.97, 0.78, 0.68}, {0.87, 0.47, 0.37}, {0.70, 0.15, 0.17}, {0.43, 0.02, 0.10}};
constexpr Colour fill[] = {
    {0.97, 0.97, 0.96}, {0.73, 0.85, 0.93}, {0.40, 0.64, 0.81}, {0.13, 0.40, 0.66}, {0.03, 0.18, 0.38}};

/// A place in OKLab (Ottosson 2020): lightness and two opponent hues, in which distances are as the eye sees them.
struct Lab {
  double l, a, b;
};

double linear(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }
double gamma(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055; }

Lab lab_of(Colour c) {
  const double r = linear(c.r), g = linear(c.g), b = linear(c.b);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

Colour colour_of(Lab c) {
  const double l = c.l + 0.3963377774 * c.a + 0.2158037573 * c.b;
  const double m = c.l - 0.1055613458 * c.a - 0.0638541728 * c.b;
  const double s = c.l - 0.0894841775 * c.a - 1.2914855480 * c.b;
  const double l3 = l * l * l, m3 = m * m * m, s3 = s * s * s;
  const auto channel = [](double v) { return std::clamp(gamma(std::clamp(v, 0.0, 1.0)), 0.0, 1.0); };
  return {channel(4.0767416621 * l3 - 3.3077115913 * m3 + 0.2309699292 * s3),
          channel(-1.2684380046 * l3 + 2.6097574011 * m3 - 0.3413193965 * s3),
          channel(-0.0041960863 * l3 - 0.7034186147 * m3 + 1.7076147010 * s3)};
}

/// Stops from z0 to z1 through the colours, as far apart as they look apart. `part`: of the way from the first colour.
void add_even(std::vector<ColourScale::Stop>& stops, std::span<const Colour> colours, double z0, double z1, double from,
              double to) {
  std::vector<Lab> places;
  std::vector<double> way = {0};
  for (const Colour& c : colours) places.push_back(lab_of(c));
  for (std::size_t k = 1; k < places.size(); ++k) {
    const Lab &p = places[k - 1], &q = places[k];
    way.push_back(way.back() + std::hypot(q.l - p.l, q.a - p.a, q.b - p.b));
  }
  constexpr int steps = 64;
  for (int i = 0; i <= steps; ++i) {
    const double part = static_cast<double>(i) / steps, at = (from + (to - from) * part) * way.back();
    std::size_t k = 1;
    while (k + 1 < way.size() && way[k] < at) ++k;
    const double t = (at - way[k - 1]) / (way[k] - way[k - 1]);
    const Lab &p = places[k - 1], &q = places[k];
    stops.push_back(
        {z0 + (z1 - z0) * part, colour_of({p.l + (q.l - p.l) * t, p.a + (q.a - p.a) * t, p.b + (q.b - p.b) * t})});
  }
}

}  // namespace

Colour ColourScale::operator()(double z) const {
  const auto next = std::upper_bound(stops_.begin(), stops_.end(), z, [](double v, const Stop& s) { return v < s.z; });
  if (next == stops_.begin()) return stops_.front().colour;
  if (next == stops_.end()) return stops_.back().colour;
  const Stop &a = *(next - 1), &b = *next;
  const double t = (z - a.z) / (b.z - a.z);
  return (1 - t) * a.colour + t * b.colour;
}

ColourScale atlas_colours(double zmin, double zmax) {
  std::vector<ColourScale::Stop> stops;
  if (zmin < 0)
    for (auto s = std::rbegin(atlas_sea); s != std::rend(atlas_sea); ++s) stops.push_back({s->at * zmin, s->colour});
  const double low = std::max(0.0, zmin);
  if (zmax > low)
    for (const RampStop& s : atlas_land) stops.push_back({low + s.at * (zmax - low), s.colour});
  else if (zmax >= 0)
    stops.push_back({low, atlas_land[2].colour});
  return ColourScale(std::move(stops));
}

ColourScale elevation_colours(double zmin, double zmax) {
  std::vector<ColourScale::Stop> stops;
  // A little of the sea beside high land is shallow, a little land beside the deep is low.
  const double deepest = std::min(zmin, -0.15 * zmax), highest = std::max(zmax, -0.15 * zmin);
  if (zmin < 0 && zmax > 0) {
    add_even(stops, sea, zmin, 0, 1 - zmin / deepest, 1);
    add_even(stops, land, 0, zmax, 0, zmax / highest);
  } else if (zmin == zmax) {
    stops = {{zmin, zmin < 0 ? sea[2] : land[2]}};
  } else {
    add_even(stops, zmax <= 0 ? std::span<const Colour>(sea) : std::span<const Colour>(land), zmin, zmax, 0, 1);
  }
  return ColourScale(std::move(stops));
}

ColourScale diverging_colours(double limit) {
  std::vector<ColourScale::Stop> stops;
  add_even(stops, cut, -limit, 0, 1, 0);
  add_even(stops, fill, 0, limit, 0, 1);
  return ColourScale(std::move(stops));
}

}  // namespace terrane
