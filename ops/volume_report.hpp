// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/volume.hpp"
#include "ops/measure.hpp"
#include "ops/operation.hpp"

namespace terrane {

struct VolumeOptions {
  double tolerance = 0;  // in height units
  double cut_factor = 1, fill_factor = 1;
};

/// The volume report of the contract, row by row: volumes from the core, figures in the units of the CRS.
class VolumeReport {
 public:
  VolumeReport(const Surface& surface, VolumeOptions options);

  /// False where the two do not overlap.
  bool add_reference(const Surface& reference, Context& context);
  void add_level(double level, Context& context);

  nlohmann::json json() const;
  std::string csv() const;

 private:
  struct Row {
    std::optional<double> level;
    Volume grid;  // in the report's units
    std::optional<Volume> ellipsoidal;  // none for local frames
    double scale_factor = 1;
  };
  using Measure = std::function<Volume(const AreaScale&)>;
  Row measured(const Measure& measure, Point2 centre) const;
  void measure_space(Volume& v, const Tin* reference, double level, Context& context) const;
  nlohmann::json row_json(const Row& row) const;

  const Surface& surface_;
  VolumeOptions options_;
  Units units_;
  std::string reference_;
  bool level_ = false;
  std::vector<Row> rows_;
};

/// Surface areas in space by side, where core/volume cannot know them because plan and height have different units; in
/// squared plan units times `scale`.
struct SpaceAreas {
  double fill = 0, cut = 0, same = 0;
};
SpaceAreas space_areas(const Tin& surface, const Tin* reference, double level, double tolerance, const Crs& crs,
                       const AreaScale& scale, Context& context);

}  // namespace terrane
