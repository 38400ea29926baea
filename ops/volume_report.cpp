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

/// A name as a cell of a table (RFC 4180).
std::string cell_of(const nlohmann::json& name) {
  if (name.is_null()) return "";
  std::string plain = name.is_string() ? name.get<std::string>() : name.dump();
  if (plain.find_first_of(",\"\r\n") == std::string::npos) return plain;
  std::string quoted = "\"";
  for (const char c : plain) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

/// What areas are weighed by where there is no grid to measure on.
AreaScale own_scale(const Crs& crs) {
  return crs.known() && crs.geographic() ? ellipsoidal_area_scale(crs) : AreaScale{};
}

}  // namespace

/// On the grid, where the CRS has one, and on the ellipsoid, where the CRS has a place on it.
std::vector<VolumeRow> VolumeMeasure::measured(const Measure& measure, Point2 centre) const {
  const bool degrees = crs_.known() && crs_.geographic();
  std::vector<VolumeRow> rows;
  for (Volume& grid : measure(degrees ? ellipsoidal_area_scale(crs_) : nullptr)) {
    scale_figures(grid, units_.area_factor, units_.area_factor * units_.height_factor);
    rows.emplace_back().grid = grid;
    if (degrees) rows.back().ellipsoidal = grid;
  }
  if (degrees || !crs_.known() || crs_.local()) return rows;
  std::vector<Volume> ellipsoidal = measure(ellipsoidal_area_scale(crs_));
  // The ellipsoidal scale gives square metres; figures in feet stay in feet.
  const double metre = units_.area == "m2" ? 1 : crs_.metres_per_length_unit();
  const double height = units_.volume == "m3" ? crs_.metres_per_height_unit() : 1;
  const bool placed = std::isfinite(centre.x) && std::isfinite(centre.y);
  const double factor = placed ? scale_factor(crs_, centre) : 1;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    scale_figures(ellipsoidal[i], 1 / (metre * metre), height / (metre * metre));
    rows[i].ellipsoidal = ellipsoidal[i];
    rows[i].scale_factor = factor;
  }
  return rows;
}

/// Plan and heights are in different units.
bool VolumeMeasure::in_two_units() const {
  return crs_.known() && (crs_.geographic() || crs_.length_unit() != crs_.height_unit());
}

/// Where plan and heights are in different units the core cannot know areas in space.
void VolumeMeasure::note_space(Volume& v, const SpaceAreas& areas) const {
  v.fill.area_3d = areas.fill * units_.area_factor;
  v.cut.area_3d = areas.cut * units_.area_factor;
  v.same_area_3d = areas.same * units_.area_factor;
}

Steepness VolumeMeasure::steepness() const {
  if (!in_two_units()) return nullptr;
  return [this](const Point& a, const Point& b, const Point& c) { return terrane::steepness(a, b, c, crs_); };
}

VolumeRow VolumeMeasure::between(const Tin& surface, const Tin& reference, Context& context) const {
  const bool apart = surface.faces.empty() || reference.faces.empty();
  const auto measure = [&](const AreaScale& scale) {
    if (!apart) return volume(surface, reference, options_.tolerance, scale, context);
    Volume none;
    if (!surface.faces.empty()) none.surface_only_area_2d = area(surface, scale);
    if (!reference.faces.empty()) none.reference_only_area_2d = area(reference, scale);
    return none;
  };
  VolumeRow row = measured([&](const AreaScale& scale) { return std::vector{measure(scale)}; },
                           middle(bounds(surface), bounds(reference)))
                      .front();
  if (apart) return row;
  if (in_two_units())
    note_space(row.grid, space_areas(surface, reference, options_.tolerance, crs_, own_scale(crs_), context));
  if (options_.polygons)
    row.areas = features(volume_areas(surface, reference, options_.tolerance, own_scale(crs_), steepness(), context));
  return row;
}

std::vector<VolumeRow> VolumeMeasure::at_levels(const Tin& surface, const std::vector<double>& levels,
                                                Context& context) const {
  const bool empty = surface.faces.empty();
  std::vector<VolumeRow> rows = measured(
      [&](const AreaScale& scale) {
        return empty ? std::vector<Volume>(levels.size())
                     : volumes(surface, levels, options_.tolerance, scale, context);
      },
      middle(bounds(surface), bounds(surface)));
  std::vector<SpaceAreas> space;
  if (in_two_units() && !empty) space = space_areas(surface, levels, options_.tolerance, crs_, own_scale(crs_));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].level = levels[i];
    if (!space.empty()) note_space(rows[i].grid, space[i]);
    if (options_.polygons && !empty)
      rows[i].areas =
          features(volume_areas(surface, levels[i], options_.tolerance, own_scale(crs_), steepness(), context));
  }
  return rows;
}

std::vector<Feature> VolumeMeasure::features(const VolumeAreas& areas) const {
  const double area = crs_.known() && crs_.geographic() ? 1 : units_.area_factor, volume = area * units_.height_factor;
  std::vector<Feature> made;
  for (const VolumeArea& of : areas.areas) {
    const char* kind = of.kind == VolumeKind::above ? "above" : of.kind == VolumeKind::below ? "below" : "same";
    made.push_back({.properties = {{"kind", kind},
                                   {"volume", of.volume * volume},
                                   {"area_2d", of.area_2d * area},
                                   {"area_3d", of.area_3d * area},
                                   {"max_dz", of.max_dz}},
                    .polygons = {of.polygon}});
  }
  return made;
}

nlohmann::json VolumeReport::row_json(const VolumeRow& row) const {
  const Volume& v = row.grid;
  const char *up = level_ ? "above" : "fill", *down = level_ ? "below" : "cut";
  nlohmann::json ellipsoidal;
  if (row.ellipsoidal)
    ellipsoidal = {{std::string(down) + "_volume", row.ellipsoidal->cut.volume},
                   {std::string(up) + "_volume", row.ellipsoidal->fill.volume},
                   {"net_volume", row.ellipsoidal->net}};
  const double adjusted = v.fill.volume * options_.fill_factor - v.cut.volume * options_.cut_factor;
  return {{"region", row.region},
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
  const Units units = units_of(surface_.crs);
  nlohmann::json rows = nlohmann::json::array();
  double residual = 0;
  for (const VolumeRow& row : rows_) {
    rows.push_back(row_json(row));
    residual = std::max(residual, row.grid.identity_residual);
  }
  return {
      {"type", "VolumeReport"},
      {"surface", surface_.name},
      {"reference", reference_},
      {"crs", surface_.crs.known() ? surface_.crs.id() : ""},
      {"units", {{"length", units.length}, {"height", units.height}, {"area", units.area}, {"volume", units.volume}}},
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
  for (const VolumeRow& row : rows_) {
    const Volume& v = row.grid;
    table.append(cell_of(row.region)).append(",").append(row.level ? text(*row.level) : "");
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

Vectors VolumeReport::polygons() const {
  Vectors all;
  for (const VolumeRow& row : rows_)
    for (Feature feature : row.areas) {
      if (!row.region.is_null()) feature.properties["region"] = row.region;
      if (row.level) feature.properties["level"] = *row.level;
      all.features.push_back(std::move(feature));
    }
  return all;
}

}  // namespace terrane
