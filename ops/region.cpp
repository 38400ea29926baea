// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/region.hpp"

#include <algorithm>

#include "core/error.hpp"

namespace terrane {
namespace {

std::vector<Polygon> polygons_of(const Vectors& region, const std::string& name, Context& context) {
  std::vector<Polygon> polygons = region.polygons();
  const std::vector<Line> lines = region.lines();
  if (polygons.empty() && lines.size() == 1 && lines[0].size() > 2) {
    if (region.geojson)
      throw Error(ErrorKind::input, "no-polygons",
                  "the " + name + " is a line that is not closed; close it, or give a polygon");
    polygons.push_back({lines[0], {}});  // corners written out
  }
  if (polygons.empty())
    throw Error(ErrorKind::input, "no-polygons",
                "the " + name + " holds no polygon and no closed line; give one that does");
  const std::size_t open = static_cast<std::size_t>(std::count_if(region.features.begin(), region.features.end(),
                                                                  [](const Feature& f) { return !f.points.empty(); }));
  if (open > 0)
    context.warn({"points-ignored", "", "", "the " + name + " holds points beside its polygons; they say nothing", ""});
  return polygons;
}

}  // namespace

PlanRegion area_of(const Vectors& vectors, const std::string& name, Context& context) {
  PlanRegion region = plan_region(polygons_of(vectors, name, context), context);
  if (region.empty())
    throw Error(ErrorKind::input, "empty-region",
                "the polygons of the " + name + " have no area; give corners off one line");
  if (region.self_crossing)
    context.warn({"region-crosses-itself", "", "",
                  "a ring of the " + name + " crosses itself or another of its polygon at " +
                      nlohmann::json(region.self_crossing->x).dump() + ", " +
                      nlohmann::json(region.self_crossing->y).dump() + "; what it encloses was decided by parity",
                  "correct the polygon"});
  return region;
}

}  // namespace terrane
