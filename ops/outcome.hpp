// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/overlay.hpp"
#include "core/raster.hpp"
#include "core/shade.hpp"
#include "core/tin.hpp"
#include "io/vectors.hpp"
#include "ops/request.hpp"

namespace terrane {

/// Heights that are possible at a place: one where the surface is smooth, a range at the foot of a wall.
struct HeightRange {
  double low = 0, high = 0;
};

/// What the result's height must be at a place, given the heights of the inputs there (none where an input has no
/// surface): the operation written a second time, on single points, to check the mesh against. None: no surface.
using HeightFold = std::function<std::optional<HeightRange>(const std::vector<std::optional<HeightRange>>& inputs)>;

class HeightField;
/// One for each input that is a TIN, in their order. They look at these: a run that makes them leaves its inputs alone.
using HeightFields = std::vector<std::shared_ptr<const HeightField>>;

/// Which input's height holds at a place (none: that of several together), given the heights of the inputs there; levels
/// are among them. For provenance.
using Decider = std::function<Index(const std::vector<std::optional<double>>& inputs)>;

/// What an operation's run returns.
struct Outcome {
  std::variant<Tin, Raster, Picture, Vectors, nlohmann::json> result;
  // What a report can be besides, where the operation has it.
  std::function<std::string()> csv;
  std::function<Vectors()> features;
  std::function<Picture()> picture;
  std::optional<RoundingReport> rounding;
  HeightFold expected_height;  // null: nothing to check heights against
  Decider decider;             // null: the lone one, else several together
  std::string policy;          // in words; empty: the operation's name
  HeightFields fields;         // where the run has needed them; else the check makes its own
  std::optional<double> expected_area;  // of the result in plan, in squared CRS units
  nlohmann::json approximation;         // what is not exact by design, beside or instead of the triangulation of rasters
  nlohmann::json certificate = nlohmann::json::object();  // joins the certificate: "seams"
  std::vector<ResultPart> parts = {};   // of an operation with several outputs
  bool verify = true;  // false: returned whatever its topology is (convert)
};

}  // namespace terrane
