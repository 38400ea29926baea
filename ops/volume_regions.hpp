// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/vectors.hpp"
#include "ops/operation.hpp"

// The parts of a surface that volumes are measured in: parcels, ponds, stockpiles.
namespace terrane {

struct VolumeRegion {
  nlohmann::json name;  // the property name, id or fid, else the number of the feature, from 1
  std::vector<Polygon> polygons;

  std::string quoted() const;
};

/// A region for each feature, polygons and closed lines alike; coordinates written out are one polygon. Throws
/// Error{input, "no-polygons"} where no feature has any.
std::vector<VolumeRegion> volume_regions(const Vectors& vectors);

/// A surface and its reference within one region.
struct VolumePart {
  Tin surface, reference;  // reference: empty where there is none
  bool no_area = false;    // the region has none
};

/// Calls work(alike, part, own) for every region, several at a time; alike: the numbers of all that have these same
/// polygons, which are cut out once. Only faces near a region are looked at for it. Warns of regions without area, of
/// those that cross themselves and of those that do not touch the surface. `reference` may be null.
using PartWork = std::function<void(const std::vector<std::size_t>& alike, const VolumePart&, Context&)>;
void for_each_part(const Surface& surface, const Tin* reference, const std::vector<VolumeRegion>& regions,
                   Context& context, const PartWork& work);

}  // namespace terrane
