// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/context.hpp"
#include "core/shapes.hpp"
#include "io/geodesy.hpp"

// Points, lines and polygons with properties: regions, profile lines, breaklines, contours. Read from GeoJSON, WKT,
// GeoPackage, zipped Shapefile, DXF, tables, or coordinates written out; written as GeoJSON, GeoPackage or DXF.
namespace terrane {

/// One row of a vector file. A geometry collection has several kinds of shapes.
struct Feature {
  nlohmann::json properties = nlohmann::json::object();  // of numbers, text, truth values and null when written
  std::vector<Point> points = {};
  std::vector<Line> lines = {};
  std::vector<Polygon> polygons = {};
};

struct Vectors {
  std::vector<Feature> features = {};
  Crs crs = {};          // as the bytes declare it; unknown when they do not
  bool geojson = false;
  bool lonlat = false;  // longitudes and latitudes are meant where no CRS is declared: GeoJSON, columns called so

  bool empty() const { return features.empty(); }
  /// All polygons; closed lines, which is what drawing programs have for polygons, are outer rings.
  std::vector<Polygon> polygons() const;
  /// All lines; rings of polygons are closed lines, their first point repeated at the end.
  std::vector<Line> lines() const;
  /// All points; of lines and polygons their corners in order.
  std::vector<Point> points() const;
};

/// The words "geojson", "gpkg", "shp" (zipped), "dxf", "wkt", "table" (a first line names the columns, x and y among
/// them), "coordinates" (x,y;x,y… or x,y,x,y…; with three numbers between semicolons or in a line the third is a height;
/// blanks do for commas), as the bytes say; none when they are nothing of these.
std::optional<std::string> vector_format(std::string_view bytes);

/// Decodes; `name` is for messages. Throws Error{input} naming the feature, and Error{limit} beyond 20 million corners.
/// No file, driver or network but the bytes given is ever looked at. All layers of a file are read, all shapefiles of a
/// zip file in whatever folders, in the order of their paths. Of a table that has nothing but places these are the
/// corners of one line, as written-out coordinates are; with other columns every row is a point with properties.
Vectors read_vectors(std::string_view bytes, const std::string& name, Context& context);

/// "geojson", "gpkg" or "dxf". Numbers of GeoJSON are exact; a CRS other than longitude and latitude on WGS 84 stands
/// in its `crs` member. DXF has the number `level` of a feature as its elevation, the text `kind` as
/// its layer, and nothing else of its properties. A
/// GeoPackage holds a table for each kind of shape. The same bytes for the same value.
std::string write_vectors(const Vectors& vectors, std::string_view word);

// What the files of this part of the room share.
Vectors read_geojson(std::string_view bytes, const std::string& name);
std::string write_geojson(const Vectors& vectors);
Vectors read_ogr_vectors(std::string_view bytes, const std::string& word, const std::string& name, Context& context);
std::string write_ogr_vectors(const Vectors& vectors, std::string_view word);
bool is_table(std::string_view text);
Vectors read_table(std::string_view bytes, const std::string& name, Context& context);

/// The CRS that vectors declare; one that cannot be understood is a warning and none.
Crs declared_crs(std::string_view definition, const std::string& name, Context& context);

inline constexpr std::size_t max_corners = 20'000'000;
inline constexpr std::size_t max_features = 2'000'000;

/// Refuses one more than `most`.
void check_features(const Vectors& vectors, std::size_t most, const std::string& name);

}  // namespace terrane
