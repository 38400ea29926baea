// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/volume_regions.hpp"

#include <atomic>
#include <bit>
#include <cstdint>
#include <map>
#include <utility>

#include "core/clip.hpp"
#include "core/error.hpp"
#include "core/face_runs.hpp"
#include "core/mosaic.hpp"
#include "core/side_by_side.hpp"

namespace terrane {
namespace {

constexpr std::size_t most_named = 20;  // regions in one warning

nlohmann::json name_of(const Feature& feature, std::size_t number) {
  for (const char* key : {"name", "id", "fid"})
    if (const auto it = feature.properties.find(key); it != feature.properties.end())
      if ((it->is_string() && !it->get_ref<const std::string&>().empty()) || it->is_number()) return *it;
  return number;
}

struct Fate {
  bool no_area = false, outside = false;
  std::optional<Point2> crossing;
};

/// One warning for all regions of which something is true.
void warn_of(const std::vector<VolumeRegion>& regions, const std::vector<Fate>& fates, bool Fate::*fate,
             const char* code, const std::string& input, const char* one, const char* many, const char* remedy,
             Context& context) {
  std::string names;
  std::size_t count = 0;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (!(fates[i].*fate)) continue;
    if (count++ < most_named) names += (names.empty() ? "" : ", ") + regions[i].quoted();
  }
  if (count == 0) return;
  if (count > most_named) names += " and " + std::to_string(count - most_named) + " more";
  context.warn({code, input, count == 1 ? "region " + names : "",
                count == 1 ? "region " + names + " " + one : "regions " + names + " " + many, remedy});
}

/// The polygons in plan as they are, bit for bit.
std::vector<std::uint64_t> key_of(const VolumeRegion& region) {
  std::vector<std::uint64_t> key;
  const auto add = [&](const Line& ring) {
    key.push_back(ring.size());
    for (const Point& p : ring)
      for (const double v : {p.x, p.y}) key.push_back(std::bit_cast<std::uint64_t>(v));
  };
  for (const Polygon& polygon : region.polygons) {
    key.push_back(polygon.holes.size());
    add(polygon.outer);
    for (const Line& hole : polygon.holes) add(hole);
  }
  return key;
}

/// Regions by what they cover: those of the same polygons together, in the order of the first of them.
std::vector<std::vector<std::size_t>> alike(const std::vector<VolumeRegion>& regions) {
  std::map<std::vector<std::uint64_t>, std::size_t> group_of;
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const auto [it, fresh] = group_of.try_emplace(key_of(regions[i]), groups.size());
    if (fresh) groups.emplace_back();
    groups[it->second].push_back(i);
  }
  return groups;
}

Tin within(const FaceRuns& faces, const PlanRegion& area, Context& context) {
  const Tin near = faces.near(widened(bounds(area.tin)));
  return near.faces.empty() ? Tin{} : clip(near, area, Side::inside, context).tin;
}

}  // namespace

std::string VolumeRegion::quoted() const {
  return name.is_string() ? "'" + name.get<std::string>() + "'" : name.dump();
}

std::vector<VolumeRegion> volume_regions(const Vectors& vectors) {
  std::vector<VolumeRegion> regions;
  bool any = false;
  for (std::size_t i = 0; i < vectors.features.size(); ++i) {
    Vectors alone;
    alone.features.push_back(vectors.features[i]);
    VolumeRegion region{name_of(vectors.features[i], i + 1), alone.polygons()};
    const std::vector<Line>& lines = vectors.features[i].lines;
    if (region.polygons.empty() && vectors.features.size() == 1 && lines.size() == 1 && lines[0].size() > 2 &&
        !vectors.geojson)
      region.polygons.push_back({lines[0], {}});  // corners written out
    any = any || !region.polygons.empty();
    regions.push_back(std::move(region));
  }
  if (!any)
    throw Error(ErrorKind::input, "no-polygons",
                "parameter 'region' holds no polygon and no closed line; give one that does");
  return regions;
}

void for_each_part(const Surface& surface, const Tin* reference, const std::vector<VolumeRegion>& regions,
                   Context& context, const PartWork& work) {
  const std::vector<std::vector<std::size_t>> groups = alike(regions);
  const FaceRuns faces(surface.tin());
  std::optional<FaceRuns> reference_faces;
  if (reference) reference_faces.emplace(*reference);
  std::vector<Fate> fates(regions.size());
  std::atomic<std::size_t> done = 0;
  const std::vector<double> weights(groups.size(), static_cast<double>(surface.tin().faces.size()));
  side_by_side(weights, context, [&](std::size_t g, Context& own) {
    const std::size_t i = groups[g].front();
    // What a part does is too short to be told apart; what counts is how many are done.
    const auto tell = own.on_progress;
    own.on_progress = [&](std::string_view, double) {
      tell("volume", static_cast<double>(done) / static_cast<double>(groups.size()));
    };
    const PlanRegion area = plan_region(regions[i].polygons, own);
    VolumePart part;
    fates[i].no_area = part.no_area = area.empty();
    fates[i].crossing = area.self_crossing;
    if (!area.empty()) {
      part.surface = within(faces, area, own);
      if (reference_faces) part.reference = within(*reference_faces, area, own);
      fates[i].outside = part.surface.faces.empty();
    }
    try {
      work(groups[g], part, own);
    } catch (const Error& error) {
      if (error.kind != ErrorKind::input) throw;
      throw Error(error.kind, error.code, "region " + regions[i].quoted() + ": " + error.what());
    }
    for (const std::size_t same : groups[g]) fates[same] = fates[i];
    ++done;
  });
  warn_of(regions, fates, &Fate::no_area, "empty-region", "", "has no area; its row is zero",
          "have no area; their rows are zero", "correct the polygon", context);
  warn_of(regions, fates, &Fate::outside, "region-outside", surface.name, "does not touch the surface; its row is zero",
          "do not touch the surface; their rows are zero", "check their CRS, or give region-crs", context);
  for (std::size_t i = 0, told = 0; i < regions.size() && told < most_named; ++i) {
    if (!fates[i].crossing) continue;
    ++told;
    context.warn({"region-crosses-itself", "", "region " + regions[i].quoted(),
                  "a ring of region " + regions[i].quoted() + " crosses itself or another at " +
                      nlohmann::json(fates[i].crossing->x).dump() + ", " + nlohmann::json(fates[i].crossing->y).dump() +
                      "; what it encloses was decided by parity",
                  "correct the polygon"});
  }
}

}  // namespace terrane
