// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <ogr_spatialref.h>

#include "io/gdal_library.hpp"
#include "io/geodesy.hpp"

// What the files of the geodesy room share. Nobody else includes this.
namespace terrane {

/// What is known of a CRS, as plain values: GDAL's own objects are not safe to share between threads, so every call
/// that needs one makes it anew from `definition`.
struct Crs::Impl {
  std::string definition;             // what OSR makes the CRS from: "EPSG:25831+5773" or WKT; empty for a local frame
  std::string horizontal_definition;  // the same without the vertical part
  std::string id, name, wkt, wkt1;
  std::string horizontal_wkt;
  bool geographic = false, local = false, ellipsoidal_heights = false;
  std::string vertical_datum = "unknown", length_unit = "m", height_unit = "m";
  double metres_per_length_unit = 1, metres_per_height_unit = 1;
  double semi_major = 6378137, inverse_flattening = 298.257223563;  // of the datum; 0: a sphere

  static std::shared_ptr<const Impl> local_frame(std::string_view unit);
  /// `code`: the register's name for it when the text was one; else empty, and the CRS's own code is looked at.
  static std::shared_ptr<const Impl> of(OGRSpatialReference srs, const std::string& code);
};

/// What GDAL and PROJ say while this lives goes nowhere: their texts may hold bytes of an input.
/// Before it no object of OSR's may be made.
struct Quiet {
  Quiet() {
    load_gdal();
    CPLPushErrorHandler(say_nothing);
  }
  ~Quiet() {
    CPLPopErrorHandler();
    CPLErrorReset();
  }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
};

/// "EPSG:25831", "EPSG:25831+5773", "OGC:CRS84" in the register's spelling, or "" when the text is no code.
std::string register_code(std::string_view text);

/// The CRS of a definition, x first. Network access is off. `definition` is one that Crs::parse made.
OGRSpatialReference osr(const std::string& definition);

using Transformation = std::unique_ptr<OGRCoordinateTransformation>;

/// Null when there is none. `lon_lat` (may be null): where, in degrees; decides between operations made for regions.
/// `ballpark`: accept an unknown datum shift as none at all; only where a rough place is enough.
Transformation make_transformation(const OGRSpatialReference& from, const OGRSpatialReference& to, const Box* lon_lat,
                                   bool ballpark);

/// The box in degrees on the CRS's own datum; all zero when it has no place there. Around 0 to 360 wide; may pass 180.
Box lon_lat_box(const Crs& crs, const Box& box);

/// False for the zero box and for boxes around the whole globe. A single place counts.
inline bool is_area(const Box& lon_lat) {
  return (lon_lat.xmin != 0 || lon_lat.xmax != 0 || lon_lat.ymin != 0 || lon_lat.ymax != 0) &&
         lon_lat.xmax >= lon_lat.xmin && lon_lat.xmax - lon_lat.xmin < 360 && lon_lat.ymax >= lon_lat.ymin;
}

/// The same area as PROJ takes it: longitudes within 180, the western one the larger where it passes there. A place at
/// 180 degrees is an area of a millionth of a degree: PROJ calls itself without end to tell where one that begins and
/// ends there lies.
inline Box area_of_interest(const Box& lon_lat) {
  Box area = {std::remainder(lon_lat.xmin, 360), lon_lat.ymin, std::remainder(lon_lat.xmax, 360), lon_lat.ymax};
  if (lon_lat.xmin == lon_lat.xmax && std::fabs(area.xmin) == 180) area.xmin = -180, area.xmax = -180 + 1e-6;
  return area;
}

/// Names of the grids that every known way from one to the other needs and that are not installed.
std::vector<std::string> missing_grids(const Crs& from, const Crs& to, const Box& lon_lat);

}  // namespace terrane
