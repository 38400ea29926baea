// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/volume_report.hpp"

#include <algorithm>
#include <cmath>

namespace terrane {
namespace {

/// Areas and volumes in the report's units.
void scale_figures(Volume& v, double area, double volume) {
  for (VolumeSide* side : {&v.fill, &v.cut}) side->volume *= volume, side->area_2d *= area, side->area_3d *= area;
  for (double* a :
       {&v.same_area_2d, &v.same_area_3d, &v.overlap_area_2d, &v.surface_only_area_2d, &v.reference_only_area_2d})
    *a *= area;
  v.net *= volume;
  v.identity_residual *= volume;
}

nlohmann::json side_json(const VolumeSide& side) {
  return {{"volume", side.volume}, {"area_2d", side.area_2d}, {"area_3d", side.area_3d}, {"max_dz", side.max_dz}};
}

Point2 middle(const Box& a, const Box& b) {
  return {(std::max(a.xmin, b.xmin) + std::min(a.xmax, b.xmax)) / 2,
          (std::max(a.ymin, b.ymin) + std::min(a.ymax, b.ymax)) / 2};
}

std::string text(double value) { return nlohmann::json(value).dump(); }

}  // namespace

VolumeReport::VolumeReport(const Surface& surface, VolumeOptions options)
    : surface_(surface), options_(options), units_(units_of(surface.crs)) {}

/// On the grid, where the CRS has one, and on the ellipsoid, where the CRS has a place on it.
VolumeReport::Row VolumeReport::measured(const Measure& measure, Point2 centre) const {
  const Crs& crs = surface_.crs;
  Row row;
  if (crs.known() && crs.geographic()) {
    row.grid = measure(ellipsoidal_area_scale(crs));
    scale_figures(row.grid, 1, units_.height_factor);
    row.ellipsoidal = row.grid;
    return row;
  }
  row.grid = measure(nullptr);
  scale_figures(row.grid, units_.area_factor, units_.area_factor * units_.height_factor);
  if (!crs.known() || crs.local()) return row;
  row.ellipsoidal = measure(ellipsoidal_area_scale(crs));
  // The ellipsoidal scale gives square metres; figures in feet stay in feet.
  const double metre = units_.area == "m2" ? 1 : crs.metres_per_length_unit();
  const double height = units_.volume == "m3" ? crs.metres_per_height_unit() : 1;
  scale_figures(*row.ellipsoidal, 1 / (metre * metre), height / (metre * metre));
  row.scale_factor = scale_factor(crs, centre);
  return row;
}

/// Where plan and heights are in different units the core cannot know areas in space.
void VolumeReport::measure_space(Volume& v, const Tin* reference, double level, Context& context) const {
  const Crs& crs = surface_.crs;
  if (!crs.known() || (!crs.geographic() && crs.length_unit() == crs.height_unit())) return;
  const AreaScale scale = crs.geographic() ? ellipsoidal_area_scale(crs) : AreaScale{};
  const auto areas = space_areas(surface_.tin(), reference, level, options_.tolerance, crs, scale, context);
  v.fill.area_3d = areas.fill * units_.area_factor;
  v.cut.area_3d = areas.cut * units_.area_factor;
  v.same_area_3d = areas.same * units_.area_factor;
}

bool VolumeReport::add_reference(const Surface& reference, Context& context) {
  reference_ = reference.name;
  const Tin &a = surface_.tin(), &b = reference.tin();
  Row row = measured([&](const AreaScale& scale) { return volume(a, b, options_.tolerance, scale, context); },
                     middle(bounds(a), bounds(b)));
  measure_space(row.grid, &b, 0, context);
  rows_.push_back(row);
  return row.grid.overlap_area_2d > 0;
}

void VolumeReport::add_level(double level, Context& context) {
  level_ = true;
  reference_ = rows_.empty() ? text(level) : "levels";
  const Tin& a = surface_.tin();
  Row row = measured([&](const AreaScale& scale) { return volume(a, level, options_.tolerance, scale, context); },
                     middle(bounds(a), bounds(a)));
  measure_space(row.grid, nullptr, level, context);
  row.level = level;
  rows_.push_back(row);
}

nlohmann::json VolumeReport::row_json(const Row& row) const {
  const Volume& v = row.grid;
  const char *up = level_ ? "above" : "fill", *down = level_ ? "below" : "cut";
  nlohmann::json ellipsoidal;
  if (row.ellipsoidal)
    ellipsoidal = {{std::string(down) + "_volume", row.ellipsoidal->cut.volume},
                   {std::string(up) + "_volume", row.ellipsoidal->fill.volume},
                   {"net_volume", row.ellipsoidal->net}};
  const double adjusted = v.fill.volume * options_.fill_factor - v.cut.volume * options_.cut_factor;
  return {{"region", nullptr},
          {"level", row.level ? nlohmann::json(*row.level) : nlohmann::json()},
          {up, side_json(v.fill)},
          {down, side_json(v.cut)},
          {"same", {{"area_2d", v.same_area_2d}, {"area_3d", v.same_area_3d}}},
          {"net_volume", v.net},
          {"adjusted",
           {{"cut_factor", options_.cut_factor}, {"fill_factor", options_.fill_factor}, {"net_volume", adjusted}}},
          {"ellipsoidal", ellipsoidal},
          {"combined_scale_factor", row.scale_factor},
          {"coverage",
           {{"overlap_area_2d", v.overlap_area_2d},
            {"surface_only_area_2d", v.surface_only_area_2d},
            {"reference_only_area_2d", v.reference_only_area_2d}}}};
}

nlohmann::json VolumeReport::json() const {
  nlohmann::json rows = nlohmann::json::array();
  double residual = 0;
  for (const Row& row : rows_) {
    rows.push_back(row_json(row));
    residual = std::max(residual, row.grid.identity_residual);
  }
  return {{"type", "VolumeReport"},
          {"surface", surface_.name},
          {"reference", reference_},
          {"crs", surface_.crs.known() ? surface_.crs.id() : ""},
          {"units",
           {{"length", units_.length}, {"height", units_.height}, {"area", units_.area}, {"volume", units_.volume}}},
          {"tolerance", options_.tolerance},
          {"rows", rows},
          {"sign", level_ ? "net = above - below" : "net = fill - cut; fill: surface above reference"},
          {"identity_residual", residual}};
}

std::string VolumeReport::csv() const {
  const std::string up = level_ ? "above" : "fill", down = level_ ? "below" : "cut";
  std::string table = "region,level";
  for (const std::string& side : {up, down})
    for (const char* figure : {"volume", "area_2d", "area_3d", "max_dz"}) table += "," + side + "_" + figure;
  table += ",same_area_2d,same_area_3d,net_volume,adjusted_net_volume,ellipsoidal_" + down + "_volume,ellipsoidal_" +
           up +
           "_volume,ellipsoidal_net_volume,combined_scale_factor,overlap_area_2d,surface_only_area_2d,reference_only_"
           "area_2d\n";
  const auto cell = [&](double figure) { table.append(",").append(text(figure)); };
  for (const Row& row : rows_) {
    const Volume& v = row.grid;
    table.append(",").append(row.level ? text(*row.level) : "");
    for (const VolumeSide& s : {v.fill, v.cut})
      for (double figure : {s.volume, s.area_2d, s.area_3d, s.max_dz}) cell(figure);
    for (double figure : {v.same_area_2d, v.same_area_3d, v.net,
                          v.fill.volume * options_.fill_factor - v.cut.volume * options_.cut_factor})
      cell(figure);
    if (row.ellipsoidal)
      for (double figure : {row.ellipsoidal->cut.volume, row.ellipsoidal->fill.volume, row.ellipsoidal->net})
        cell(figure);
    else
      table += ",,,";
    for (double figure : {row.scale_factor, v.overlap_area_2d, v.surface_only_area_2d, v.reference_only_area_2d})
      cell(figure);
    table += "\n";
  }
  return table;
}

}  // namespace terrane
