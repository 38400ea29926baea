// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "core/error.hpp"
#include "io/text.hpp"
#include "io/vectors.hpp"

// GeoJSON (RFC 7946), with the `crs` member of its predecessor.
namespace terrane {
namespace {

using Json = nlohmann::json;

constexpr int max_depth = 64;
constexpr std::size_t max_bytes = 128 << 20;  // as a tree it takes some ten times that

class Reader {
 public:
  explicit Reader(const std::string& name) : name_(name) {}

  Vectors read(std::string_view bytes) {
    if (bytes.size() > max_bytes)
      throw Error(ErrorKind::limit, "too-large",
                  name_ + ": more than 128 MiB of GeoJSON; thin it, or send it as a GeoPackage");
    const Json root = parse(without_mark(bytes));
    Vectors vectors;
    vectors.geojson = vectors.lonlat = true;
    vectors.crs = crs_of(root);
    const std::string type = type_of(root, "the document");
    if (type == "FeatureCollection") {
      const auto features = root.find("features");
      if (features == root.end() || !features->is_array()) bad("the collection has no array 'features'");
      for (const Json& feature : *features) {
        element_ = "feature " + std::to_string(vectors.features.size());
        vectors.features.push_back(feature_of(feature));
      }
    } else {
      element_ = "feature 0";
      vectors.features.push_back(type == "Feature" ? feature_of(root) : geometry_alone(root));
    }
    return vectors;
  }

 private:
  [[noreturn]] void bad(const std::string& what) const {
    throw Error(ErrorKind::input, "bad-geojson", name_ + (element_.empty() ? "" : ", " + element_) + ": " + what);
  }

  Json parse(std::string_view text) const {
    const auto depth = [&](int level, Json::parse_event_t, Json&) {
      if (level > max_depth) bad("brackets are nested deeper than " + std::to_string(max_depth));
      return true;
    };
    Json root = Json::parse(text, depth, false);
    if (root.is_discarded()) bad("this is no JSON, or it is cut off");
    if (!root.is_object()) bad("GeoJSON is an object");
    return root;
  }

  std::string type_of(const Json& object, const char* what) const {
    const auto type = object.is_object() ? object.find("type") : object.end();
    if (!object.is_object() || type == object.end() || !type->is_string())
      bad(std::string(what) + " has no 'type'; GeoJSON has FeatureCollection, Feature or a geometry's");
    return *type;
  }

  Crs crs_of(const Json& root) const {
    const auto crs = root.find("crs");
    if (crs == root.end()) return {};
    if (crs->is_object() && crs->contains("properties") && crs->at("properties").is_object())
      if (const auto name = crs->at("properties").find("name");
          name != crs->at("properties").end() && name->is_string())
        try {
          return Crs::parse(name->get_ref<const std::string&>());
        } catch (const Error&) {
        }
    bad("its crs member is not understood; it is {\"type\": \"name\", \"properties\": {\"name\": \"EPSG:25831\"}}");
  }

  Feature feature_of(const Json& object) {
    if (type_of(object, "it") != "Feature") bad("a collection holds objects of type Feature");
    const auto geometry = object.find("geometry");
    Feature feature;
    if (geometry != object.end() && !geometry->is_null()) feature = geometry_alone(*geometry);
    if (const auto properties = object.find("properties"); properties != object.end() && properties->is_object())
      feature.properties = *properties;
    if (const auto id = object.find("id"); id != object.end() && !feature.properties.contains("id"))
      feature.properties["id"] = *id;
    return feature;
  }

  Feature geometry_alone(const Json& geometry) {
    Feature feature;
    add_geometry(geometry, feature);
    return feature;
  }

  void add_geometry(const Json& geometry, Feature& feature) {
    const std::string type = type_of(geometry, "its geometry");
    if (type == "GeometryCollection") {
      const auto parts = geometry.find("geometries");
      if (parts == geometry.end() || !parts->is_array()) bad("the collection has no array 'geometries'");
      for (const Json& part : *parts) add_geometry(part, feature);
      return;
    }
    const auto coordinates = geometry.find("coordinates");
    if (coordinates == geometry.end() || !coordinates->is_array()) bad("its geometry has no array 'coordinates'");
    if (type == "Point")
      feature.points.push_back(point(*coordinates));
    else if (type == "MultiPoint")
      for (const Point& p : line(*coordinates, 0)) feature.points.push_back(p);
    else if (type == "LineString")
      feature.lines.push_back(line(*coordinates, 2));
    else if (type == "MultiLineString")
      for (const Json& part : *coordinates) feature.lines.push_back(line(part, 2));
    else if (type == "Polygon")
      feature.polygons.push_back(polygon(*coordinates));
    else if (type == "MultiPolygon")
      for (const Json& part : *coordinates) feature.polygons.push_back(polygon(part));
    else
      bad("there is no geometry of type '" + type.substr(0, 40) + "' in GeoJSON");
  }

  Point point(const Json& position) {
    const auto number = [&](std::size_t i) -> double {
      const double value = position[i].is_number() ? position[i].get<double>() : NAN;
      if (!std::isfinite(value)) bad("a position is an array of two or three finite numbers");
      return value;
    };
    if (!position.is_array() || position.size() < 2) bad("a position is an array of two or three finite numbers");
    if (++corners_ > max_corners) throw Error(ErrorKind::limit, "too-many-corners", name_ + ": too many corners");
    return {number(0), number(1), position.size() > 2 ? number(2) : NAN};
  }

  Line line(const Json& positions, std::size_t least) {
    if (!positions.is_array() || positions.size() < least)
      bad("a line is an array of at least " + std::to_string(least) + " positions");
    Line line;
    line.reserve(positions.size());
    for (const Json& position : positions) line.push_back(point(position));
    return line;
  }

  Line ring(const Json& positions) {
    Line ring = line(positions, 4);
    if (ring.front().x != ring.back().x || ring.front().y != ring.back().y) bad("a ring does not end where it begins");
    ring.pop_back();
    return ring;
  }

  Polygon polygon(const Json& rings) {
    if (!rings.is_array() || rings.empty()) bad("a polygon is an array of rings");
    Polygon polygon{ring(rings[0]), {}};
    for (std::size_t i = 1; i < rings.size(); ++i) polygon.holes.push_back(ring(rings[i]));
    return polygon;
  }

  const std::string& name_;
  std::string element_;
  std::size_t corners_ = 0;
};

void put(std::string& out, const Point& p) {
  char buffer[3 * number_size + 8];
  char* to = put_text(buffer, "[");
  to = put_text(put_number(to, p.x + 0.0), ",");
  to = put_number(to, p.y + 0.0);
  if (!std::isnan(p.z)) to = put_number(put_text(to, ","), p.z + 0.0);
  out.append(buffer, put_text(to, "]"));
}

void put(std::string& out, const Line& line, bool ring) {
  out += '[';
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (i > 0) out += ',';
    put(out, line[i]);
  }
  if (ring && !line.empty()) {
    out += ',';
    put(out, line.front());
  }
  out += ']';
}

void put(std::string& out, const Polygon& polygon) {
  out += '[';
  put(out, polygon.outer, true);
  for (const Line& hole : polygon.holes) {
    out += ',';
    put(out, hole, true);
  }
  out += ']';
}

/// {"type": "Point", …} or its multiple.
template <class Shapes, class Put>
std::string geometry(const char* kind, const Shapes& shapes, Put put_one) {
  std::string out = std::string(R"({"type":")") + (shapes.size() == 1 ? "" : "Multi") + kind + R"(","coordinates":)";
  if (shapes.size() != 1) out += '[';
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (i > 0) out += ',';
    put_one(out, shapes[i]);
  }
  if (shapes.size() != 1) out += ']';
  return out + '}';
}

std::string geometry_of(const Feature& f) {
  std::vector<std::string> parts;
  if (!f.points.empty()) parts.push_back(geometry("Point", f.points, [](auto& out, auto& p) { put(out, p); }));
  if (!f.lines.empty())
    parts.push_back(geometry("LineString", f.lines, [](auto& out, auto& line) { put(out, line, false); }));
  if (!f.polygons.empty()) parts.push_back(geometry("Polygon", f.polygons, [](auto& out, auto& p) { put(out, p); }));
  if (parts.empty()) return "null";
  if (parts.size() == 1) return parts[0];
  std::string out = R"({"type":"GeometryCollection","geometries":[)";
  for (std::size_t i = 0; i < parts.size(); ++i) out += (i > 0 ? "," : "") + parts[i];
  return out + "]}";
}

std::string crs_member(const Crs& crs) {
  if (!crs.known() || crs.local()) return "";
  const std::string id = crs.id();
  if (id == "OGC:CRS84" || id == "EPSG:4326") return "";
  const Json member = {{"type", "name"}, {"properties", {{"name", id}}}};
  return "\"crs\":" + member.dump() + ",\n";
}

}  // namespace

Vectors read_geojson(std::string_view bytes, const std::string& name) { return Reader(name).read(bytes); }

std::string write_geojson(const Vectors& vectors) {
  std::string out = "{\"type\":\"FeatureCollection\",\n" + crs_member(vectors.crs) + "\"features\":[";
  for (std::size_t i = 0; i < vectors.features.size(); ++i) {
    const Feature& f = vectors.features[i];
    out += i > 0 ? ",\n" : "\n";
    out += R"({"type":"Feature","properties":)" + f.properties.dump(-1, ' ', false, Json::error_handler_t::replace) +
           ",\"geometry\":" + geometry_of(f) + "}";
  }
  return out + "\n]}\n";
}

}  // namespace terrane
