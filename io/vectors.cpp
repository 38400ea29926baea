// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vectors.hpp"

#include <cmath>

#include "core/error.hpp"
#include "io/text.hpp"

namespace terrane {
namespace {

bool same_place(const Point& a, const Point& b) { return a.x == b.x && a.y == b.y; }

/// Numbers separated by commas, in one line also by blanks; none when something else stands there.
std::optional<std::vector<double>> numbers(std::string_view text) {
  const bool one_line = trimmed(text).find('\n') == std::string_view::npos;
  std::vector<double> values;
  const char *p = text.data(), *const end = p + text.size();
  for (;;) {
    double value = 0;
    p = skip_spaces(p, end);
    p = p == end ? nullptr : parse_number(p, end, value);
    if (!p) return {};
    values.push_back(value);
    p = skip_spaces(p, end);
    if (p == end) return values;
    if (*p == ',') ++p;
    else if (!one_line || !is_space(p[-1])) return {};
  }
}

/// "x,y;x,y", "x,y,z;x,y,z" (lines end like semicolons do), or "x,y,x,y".
std::optional<Line> coordinates(std::string_view text) {
  Line line;
  if (text.find(';') == std::string_view::npos) {
    const auto values = numbers(text);
    const bool pairs = values && values->size() % 2 == 0;
    for (std::size_t i = 0; pairs && i < values->size(); i += 2) line.push_back({(*values)[i], (*values)[i + 1], NAN});
    if (values) return pairs ? std::optional(line) : std::nullopt;
  }
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(";\n"), text.size());
    const std::string_view point = trimmed(text.substr(0, end));
    text = text.substr(std::min(end + 1, text.size()));
    if (point.empty() && (text.empty() || !line.empty())) continue;
    const auto values = numbers(point);
    if (!values || values->size() < 2 || values->size() > 3) return {};
    line.push_back({(*values)[0], (*values)[1], values->size() == 3 ? (*values)[2] : NAN});
  }
  return line.empty() ? std::nullopt : std::optional(std::move(line));
}

bool starts_with_word(std::string_view text, std::string_view word) {
  return lower(text.substr(0, word.size())) == word;
}

bool is_wkt(std::string_view text) {
  for (const char* word : {"point", "multipoint", "linestring", "multilinestring", "polygon", "multipolygon",
                           "geometrycollection", "triangle", "tin", "polyhedralsurface", "curvepolygon", "multisurface",
                           "compoundcurve", "circularstring", "multicurve"})
    if (starts_with_word(text, word)) {
      const std::string_view rest = trimmed(text.substr(std::string_view(word).size()));
      return rest.starts_with('(') || starts_with_word(rest, "z") || starts_with_word(rest, "m") ||
             starts_with_word(rest, "empty");
    }
  return false;
}

/// A group code, then SECTION or a comment (999).
bool is_dxf(std::string_view text) {
  if (text.starts_with("AutoCAD Binary DXF")) return true;
  const std::size_t line = text.find('\n');
  if (line == std::string_view::npos) return false;
  const std::string_view code = trimmed(text.substr(0, line));
  return code == "999" || (code == "0" && trimmed(text.substr(line, 16)).starts_with("SECTION"));
}

}  // namespace

std::vector<Polygon> Vectors::polygons() const {
  std::vector<Polygon> all;
  for (const Feature& f : features) {
    all.insert(all.end(), f.polygons.begin(), f.polygons.end());
    for (const Line& line : f.lines)
      if (line.size() > 3 && same_place(line.front(), line.back())) all.push_back({{line.begin(), line.end() - 1}, {}});
  }
  return all;
}

std::vector<Line> Vectors::lines() const {
  std::vector<Line> all;
  const auto add_ring = [&](const Line& ring) {
    all.push_back(ring);
    if (!ring.empty()) all.back().push_back(ring.front());
  };
  for (const Feature& f : features) {
    all.insert(all.end(), f.lines.begin(), f.lines.end());
    for (const Polygon& polygon : f.polygons) {
      add_ring(polygon.outer);
      for (const Line& hole : polygon.holes) add_ring(hole);
    }
  }
  return all;
}

std::vector<Point> Vectors::points() const {
  std::vector<Point> all;
  const auto add = [&](const Line& line) { all.insert(all.end(), line.begin(), line.end()); };
  for (const Feature& f : features) {
    add(f.points);
    for (const Line& line : f.lines) add(line);
    for (const Polygon& polygon : f.polygons) {
      add(polygon.outer);
      for (const Line& hole : polygon.holes) add(hole);
    }
  }
  return all;
}

std::optional<std::string> vector_format(std::string_view bytes) {
  if (bytes.starts_with(std::string_view("SQLite format 3\0", 16))) return "gpkg";
  if (bytes.starts_with("PK\3\4")) return "shp";
  const std::string_view text = trimmed(without_mark(bytes.substr(0, 4096)));
  if (text.starts_with('{')) return "geojson";
  if (is_dxf(text)) return "dxf";
  if (is_wkt(text)) return "wkt";
  if (is_table(text)) return "table";
  if (coordinates(bytes)) return "coordinates";
  return {};
}

Vectors read_vectors(std::string_view bytes, const std::string& name, Context& context) {
  const auto word = vector_format(bytes);
  if (!word)
    throw Error(ErrorKind::input, "unsupported-format",
                name + ": it is none of GeoJSON, WKT, GeoPackage, zipped Shapefile, DXF, no table whose first line "
                       "names x and y, and no coordinates x,y;x,y");
  if (*word == "geojson") return read_geojson(bytes, name);
  if (*word == "table") return read_table(bytes, name, context);
  if (*word != "coordinates") return read_ogr_vectors(bytes, *word, name, context);
  Vectors vectors;
  Line line = *coordinates(bytes);
  Feature feature;
  (line.size() == 1 ? feature.points : feature.lines.emplace_back()) = std::move(line);
  vectors.features.push_back(std::move(feature));
  return vectors;
}

Crs declared_crs(std::string_view definition, const std::string& name, Context& context) {
  try {
    return Crs::parse(definition);
  } catch (const Error&) {
    context.warn({"bad-crs", name, "",
                  "the coordinate reference system that " + name + " declares is not understood",
                  "say which one it is in with the parameter's -crs"});
    return {};
  }
}

void check_features(const Vectors& vectors, std::size_t most, const std::string& name) {
  if (vectors.features.size() >= most)
    throw Error(ErrorKind::limit, "too-many-features",
                name + ": more than " + std::to_string(most) + " features; send those that count");
}

std::string write_vectors(const Vectors& vectors, std::string_view word) {
  return word == "geojson" ? write_geojson(vectors) : write_ogr_vectors(vectors, word);
}

}  // namespace terrane
