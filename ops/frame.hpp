// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "ops/operation.hpp"

// From inputs as they came to TINs in one coordinate reference system.
namespace terrane {

/// What the certificate says of an input.
struct InputRecord {
  std::string slot, name, sha256;
  Crs crs = {};
  std::optional<double> level = {};  // the input is a number
  std::string word = {};        // the input is the word of its slot
  std::size_t vertices = 0, faces = 0;
  std::optional<double> area_2d = {};  // of its own domain in the frame; none where rasters were joined
  std::string joined = {};  // what it became part of when rasters were joined
  bool raster = false;
};

struct Frame {
  Crs crs;  // of the result; unknown when no input has one
  std::vector<InputRecord> inputs;  // in the order given
  nlohmann::json reprojection;  // null when nothing was transformed
};

/// Brings the surfaces into one frame: CRS rules, unwrapping, rasters joined and triangulated, everything checked.
/// Throws Error{input}: mixed-crs, missing-crs, vertical-datum, outside-crs, ...
Frame common_frame(std::vector<Surface>& surfaces, const Plan& plan, Context& context);

/// Step 1: the CRS of each surface by `crs`, what its bytes say, and `assume-crs`, in this order.
void assign_crs(std::vector<Surface>& surfaces, const Plan& plan);

/// Step 2: the one CRS of the frame. Throws where they differ and target-crs does not settle it; warns about unknown
/// ones,
/// vertical datums and units that look mistaken.
Crs choose_crs(const std::vector<Surface>& surfaces, const Plan& plan, Context& context);

/// The vector parameters of a plan, decoded, in the frame's CRS. Where they are: what NAME-crs says, else what their
/// bytes declare, else longitudes and latitudes for GeoJSON and the frame's own CRS for everything else. Where the
/// frame has degrees they are laid over the surfaces by whole turns, as tiles are laid beside each other. Throws
/// Error{input, "outside-crs"} for an edge that is torn apart where the frame's map of the globe ends.
std::map<std::string, Vectors> vectors_in_frame(const Plan& plan, const std::vector<Surface>& surfaces,
                                                const Crs& frame, Context& context);

Box box_of(const Surface& surface);

/// A raster of which only the cells are asked for (InputSlot::lattice).
bool is_lattice(const Surface& surface, const Operation& operation);

/// A raster as a TIN in the frame's CRS.
struct DemTin {
  Tin tin;
  double error = 0;  // measured over every sample of the domain, as transformed
  double planarity_error = 0;
};
struct DemOptions {
  double max_error = 0;  // in height units of the frame's CRS, against the samples as transformed
  std::size_t max_triangles = 0;
};
DemTin dem_tin(const Raster& dem, const Crs& from, const Crs& to, const std::string& name, const DemOptions& options,
               Context& context);

/// Places and heights moved from one CRS to another, units of heights included. No-op where they agree.
/// Throws Error{input, "turned-over"} naming a face that the transformation turns over.
void move_to(Tin& tin, const Crs& from, const Crs& to, const std::string& name, double& planarity_error,
             Context& context);
void move_points(std::vector<Point>& points, const Crs& from, const Crs& to);
/// Whether moving from one to the other changes anything.
bool differs(const Crs& from, const Crs& to);

}  // namespace terrane
