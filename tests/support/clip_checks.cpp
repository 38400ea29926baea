// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/clip_checks.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <tuple>

#include "core/merge.hpp"
#include "core/validate.hpp"
#include "core/volume.hpp"
#include "support/checks.hpp"

namespace terrane::support {

Line ring(std::initializer_list<Point2> corners) {
  Line line;
  for (const Point2 p : corners) line.push_back({p.x, p.y, std::nan("")});
  return line;
}

Line star(Point2 centre, double least, double most, int n, Random& random) {
  Line line;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n, r = uniform(random, least, most);
    line.push_back({centre.x + r * std::cos(angle), centre.y + r * std::sin(angle), std::nan("")});
  }
  return line;
}

namespace {

bool inside_ring(const Line& line, Point2 p) {
  bool odd = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Point &a = line[i], &b = line[(i + 1) % line.size()];
    if ((a.y <= p.y) == (b.y <= p.y)) continue;
    if (a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y) > p.x) odd = !odd;
  }
  return odd;
}

double to_ring(const Line& line, Point2 p) {
  double least = INFINITY;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Point &a = line[i], &b = line[(i + 1) % line.size()];
    const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
    const double t = square > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0) : 0;
    least = std::min(least, std::hypot(a.x + t * dx - p.x, a.y + t * dy - p.y));
  }
  return least;
}

std::tuple<double, double, double> key(const Point& p) { return {p.x, p.y, p.z}; }

/// The area of the faces and walls in space.
double area_of(const Tin& tin, bool walls) {
  double sum = 0;
  for (const Face& f : tin.faces) {
    if (is_wall(tin, f) != walls) continue;
    const Point &a = tin.vertices[f[0]], &b = tin.vertices[f[1]], &c = tin.vertices[f[2]];
    const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z, vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
    sum += 0.5 * std::hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
  }
  return sum;
}

}  // namespace

bool inside(const std::vector<Polygon>& polygons, Point2 place) {
  return std::any_of(polygons.begin(), polygons.end(), [&](const Polygon& polygon) {
    return inside_ring(polygon.outer, place) && std::none_of(polygon.holes.begin(), polygon.holes.end(),
                                                             [&](const Line& h) { return inside_ring(h, place); });
  });
}

bool near_border(const std::vector<Polygon>& polygons, Point2 place, double distance) {
  return std::any_of(polygons.begin(), polygons.end(), [&](const Polygon& polygon) {
    return to_ring(polygon.outer, place) < distance ||
           std::any_of(polygon.holes.begin(), polygon.holes.end(),
                       [&](const Line& h) { return to_ring(h, place) < distance; });
  });
}

Tin put_together(const Tin& a, const Tin& b) {
  Tin both;
  std::map<std::tuple<double, double, double>, Index> number;
  for (const Tin* tin : {&a, &b})
    for (const Face& f : tin->faces) {
      Face face;
      for (int k = 0; k < 3; ++k) {
        const Point& p = tin->vertices[f[k]];
        const auto [it, fresh] = number.try_emplace(key(p), static_cast<Index>(both.vertices.size()));
        if (fresh) both.vertices.push_back(p);
        face[k] = it->second;
      }
      both.faces.push_back(face);
    }
  return canonical(std::move(both));
}

double wall_area(const Tin& tin) { return area_of(tin, true); }

std::string wrong_with_clips(const Tin& surface, const std::vector<Polygon>& polygons, std::uint64_t seed) {
  std::ostringstream wrong;
  Context context;
  const PlanRegion region = plan_region(polygons, context);
  const Tin in = clip(surface, region, Side::inside, context).tin,
            out = clip(surface, region, Side::outside, context).tin;
  for (const Tin* tin : {&in, &out})
    if (const std::string bad = wrong_with(*tin); !bad.empty()) wrong << (tin == &in ? "inside: " : "outside: ") << bad;

  const double whole = plan_area(surface), parts = plan_area(in) + plan_area(out);
  if (std::fabs(parts - whole) > 1e-12 * whole) wrong << "areas add up to " << parts - whole << " more; ";

  const Sampler z(surface), z_in(in), z_out(out);
  double largest = 1;
  for (const Point& p : surface.vertices) largest = std::max(largest, std::fabs(p.z));
  for (const Point2 p : random_places(bounds(surface), 2000, seed)) {
    if (near_border(polygons, p, 1e-5) || !z.clear_of_edges(p, 1e-5)) continue;
    const double expected = z(p);
    const bool is_in = inside(polygons, p);
    const double here = is_in ? z_in(p) : z_out(p), there = is_in ? z_out(p) : z_in(p);
    if (!std::isnan(there)) wrong << "a face on the wrong side at " << p.x << " " << p.y << "; ";
    if (std::isnan(expected) != std::isnan(here)) wrong << "domains differ at " << p.x << " " << p.y << "; ";
    if (std::fabs(expected - here) > 1e-9 * largest) wrong << "heights differ at " << p.x << " " << p.y << "; ";
  }

  std::set<std::tuple<double, double, double>> there;
  for (const Tin* tin : {&in, &out})
    for (const Point& p : tin->vertices) there.insert(key(p));
  std::size_t missing = 0;
  for (const Point& p : surface.vertices) missing += !there.count(key(p));
  if (missing > 0) wrong << missing << " vertices are missing; ";

  const Tin united = put_together(in, out);
  if (const std::string bad = wrong_with(united); !bad.empty()) wrong << "side by side: " << bad;
  const Inspection before = inspect(surface), after = inspect(united);
  if (before.components != after.components) wrong << "side by side " << after.components << " components; ";
  if (before.holes != after.holes) wrong << "side by side " << after.holes << " holes; ";

  if (before.walls == 0 && !in.faces.empty() && !out.faces.empty()) {
    const Tin merged = merge({in, out}, {Overlap::first, {Seam::wall, 0}}, context).surface.tin;
    // Mending on cliffs an ulp wide makes walls; what runs along the cut a merge raises again.
    const bool cliffs = after.walls > 0 || inspect(merged).walls > 0;
    if (cliffs && std::fabs(plan_area(merged) - whole) > 1e-12 * whole) wrong << "a merge of the clips loses area; ";
    if (!cliffs && !(merged == united)) wrong << "a merge of the clips is not what they are side by side; ";
  }
  return wrong.str();
}

}  // namespace terrane::support
