// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/volume.hpp"
#include "core/volume_areas.hpp"
#include "io/vectors.hpp"
#include "ops/measure.hpp"
#include "ops/operation.hpp"

namespace terrane {

struct VolumeOptions {
  double tolerance = 0;  // in height units
  double cut_factor = 1, fill_factor = 1;
  bool polygons = false;
};

/// A row of the report, figures in its units.
struct VolumeRow {
  nlohmann::json region = nullptr;  // the name of a part of the surface; null: all of it
  std::optional<double> level;
  Volume grid;
  std::optional<Volume> ellipsoidal;  // none for local frames
  double scale_factor = 1;
  std::vector<Feature> areas;  // above, same, below as polygons, when they are asked for
};

/// Surface areas in space by side, where core/volume cannot know them because plan and height have different units; in
/// squared plan units times `scale`.
struct SpaceAreas {
  double fill = 0, cut = 0, same = 0;
};
SpaceAreas space_areas(const Tin& surface, const Tin& reference, double tolerance, const Crs& crs,
                       const AreaScale& scale, Context& context);
/// For each level.
std::vector<SpaceAreas> space_areas(const Tin& surface, const std::vector<double>& levels, double tolerance,
                                    const Crs& crs, const AreaScale& scale);

/// Measures rows: volumes from the core, figures in the units of the CRS. Many threads may, each with its own context.
class VolumeMeasure {
 public:
  VolumeMeasure(const Crs& crs, VolumeOptions options) : crs_(crs), options_(options), units_(units_of(crs)) {}

  /// Either surface may be empty.
  VolumeRow between(const Tin& surface, const Tin& reference, Context& context) const;
  /// A row for each level.
  std::vector<VolumeRow> at_levels(const Tin& surface, const std::vector<double>& levels, Context& context) const;

 private:
  using Measure = std::function<std::vector<Volume>(const AreaScale&)>;
  std::vector<VolumeRow> measured(const Measure& measure, Point2 centre) const;
  void note_space(Volume& v, const SpaceAreas& areas) const;
  std::vector<Feature> features(const VolumeAreas& areas) const;
  Steepness steepness() const;
  bool in_two_units() const;

  const Crs& crs_;
  VolumeOptions options_;
  Units units_;
};

/// The volume report of the contract, row by row.
class VolumeReport {
 public:
  /// `level`: the reference is one, or several.
  VolumeReport(const Surface& surface, std::string reference, bool level, VolumeOptions options)
      : surface_(surface), reference_(std::move(reference)), level_(level), options_(options) {}

  void add(VolumeRow row) { rows_.push_back(std::move(row)); }
  const std::vector<VolumeRow>& rows() const { return rows_; }

  nlohmann::json json() const;
  std::string csv() const;
  /// The areas of all rows, each with its row's region and level.
  Vectors polygons() const;

 private:
  nlohmann::json row_json(const VolumeRow& row) const;

  const Surface& surface_;
  std::string reference_;
  bool level_;
  VolumeOptions options_;
  std::vector<VolumeRow> rows_;
};

}  // namespace terrane
