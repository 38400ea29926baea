// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/context.hpp"
#include "core/raster.hpp"
#include "core/tin.hpp"
#include "core/volume.hpp"

// Coordinate reference systems: the only caller of PROJ/OSR and GeographicLib. x is always longitude or easting.
namespace terrane {

/// Loads PROJ and GDAL now, for a process that goes on as many. Throws Error{internal}.
void load_geodesy();

/// Does the text of a CRS name grid files, or hold PROJ strings that could? They would be opened when the text is read
/// or coordinates are transformed.
bool names_files(std::string_view text);

/// A coordinate reference system as a value; default-constructed: none known. Cheap to copy.
class Crs {
 public:
  Crs() = default;
  /// "EPSG:25831", "EPSG:25831+5773", WKT 1 or 2, PROJJSON, an opengis.net URI, or "local:m", "local:ft", "local:ftUS".
  /// Never touches files or the network. Throws Error{usage, "bad-crs"}.
  static Crs parse(std::string_view text);

  bool known() const { return impl_ != nullptr; }
  bool geographic() const;               // degrees
  bool local() const;                    // a local frame: units, but no place on the Earth
  std::string id() const;                // "EPSG:25831" when it has one, else WKT 2 in one line; "" for none
  std::string name() const;
  std::string wkt() const;               // WKT 2:2019, one line; "" for none and local
  std::string wkt1() const;              // WKT 1 (GDAL flavour) for formats that need it
  std::string vertical_datum() const;    // "unknown" when nothing says
  std::string length_unit() const;       // "m", "ft", "ftUS", "degree"
  std::string height_unit() const;       // "m", "ft", "ftUS"
  double metres_per_length_unit() const; // projected and local; 1 for geographic
  double metres_per_height_unit() const;
  Crs horizontal() const;                // without the vertical part

  /// Equality of the plan part: same coordinates mean the same place. (Vertical datums are compared apart.)
  bool same_plan(const Crs& other) const;

  struct Impl;  // io/geodesy_osr.hpp, for the files of this room
  const Impl& inside() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Transforms every vertex. Heights are shifted only when both CRSs have a vertical datum that is known and differs;
/// a missing geoid grid is Error{input, "missing-grid"} naming it. Throws Error{input, "outside-crs"} naming a
/// vertex that the target cannot hold. A height unit that the CRS only implies is converted with a warning. Faces stay;
/// the caller checks that none turned over.
/// `planarity_error`: the largest vertical distance, in the target, between an edge's midpoint transformed and the
/// surface of the transformed faces at its place: how much straight edges bend.
Tin transform(const Tin& tin, const Crs& from, const Crs& to, double* planarity_error, Context& context);

/// Places of (x, y, z) transformed in bulk, same rules. Failed points become NaN instead of throwing.
void transform_points(std::vector<Point>& points, const Crs& from, const Crs& to);

/// Puts tiles in one geographic CRS on one sheet: whole tiles are shifted by multiples of 360 degrees so that they lie
/// beside each other, the result within [-180, 180] wherever it does not cross the antimeridian. Returns the shift
/// per box.
std::vector<double> unwrap_longitudes(const std::vector<Box>& boxes);

/// True m2 on the ellipsoid per unit of plan area of the CRS; for local frames the units alone.
AreaScale ellipsoidal_area_scale(const Crs& crs);
/// m2 per unit of plan area, the map projection taken at its word; geographic CRSs have none and get the ellipsoidal
/// one.
AreaScale grid_area_scale(const Crs& crs);
/// Mean combined (area) scale factor sqrt(grid area / ellipsoidal area) at a place; 1 for geographic and local.
double scale_factor(const Crs& crs, Point2 at);

/// How long the straight line from a to b is, in the CRS's length unit. Where coordinates are degrees: a line straight in
/// degrees, its length on the ellipsoid in metres, to 1e-10 of it, the same in one piece and in several. Throws
/// Error{input, "outside-crs"} for a latitude beyond 90.
double line_length(const Crs& crs, Point2 a, Point2 b);

/// The places that lie so many metres east and north of `from`, each along the geodesic in that direction; longitudes
/// within 180 degrees of it. Precondition: the CRS is geographic. Throws Error{usage, "outside-crs"} where a pole or a
/// latitude beyond it is in the way.
std::vector<Point2> places_around(const Crs& crs, Point2 from, const std::vector<Point2>& offsets);

/// A CRS that would suit tiles in these boxes and CRSs: a UTM zone, or a Lambert azimuthal equal-area around them.
Crs suggest_crs(const std::vector<Box>& boxes, const std::vector<Crs>& crs);

}  // namespace terrane
