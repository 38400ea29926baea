// SPDX-License-Identifier: GPL-3.0-or-later
#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <ogr_geometry.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/error.hpp"
#include "io/gdal.hpp"
#include "io/geodesy_osr.hpp"
#include "io/sqlite_schema.hpp"
#include "io/text.hpp"
#include "io/utf8.hpp"
#include "io/vectors.hpp"
#include "io/zipped_shapefile.hpp"

// WKT, GeoPackage, zipped Shapefile and DXF through GDAL: bytes in memory, one named driver.
namespace terrane {
namespace {

constexpr std::size_t max_drawn = 400'000;  // of a drawing, whose few bytes may insert a block any number of times

void register_vector_drivers() {
  static const bool done = [] {
    RegisterOGRGeoPackage();
    RegisterOGRShape();
    RegisterOGRDXF();
    return true;
  }();
  (void)done;
}

class Reader {
 public:
  Reader(const std::string& name, Context& context) : name_(name), context_(context) {}

  Vectors wkt(std::string_view bytes) {
    refuse_zero_bytes(bytes);
    const std::string text(trimmed(without_mark(bytes)));
    const char* at = text.c_str();
    OGRGeometry* made = nullptr;
    const OGRErr error = OGRGeometryFactory::createFromWkt(&at, nullptr, &made);
    const std::unique_ptr<OGRGeometry> geometry(made);
    if (error != OGRERR_NONE || !geometry) bad("bad-wkt", "this is no WKT geometry, or it is cut off");
    if (!trimmed(at).empty()) bad("bad-wkt", "something follows after the geometry; use one GEOMETRYCOLLECTION");
    element_ = "the geometry";
    Vectors vectors;
    add_shapes(*geometry, vectors.features.emplace_back());
    return vectors;
  }

  Vectors file(std::string_view bytes, const std::string& word) {
    if (word == "gpkg") refuse_programs(bytes);
    std::string ended;
    if (word == "dxf") {
      refuse_zero_bytes(bytes);
      if (bytes.ends_with('\r')) bytes = ended = std::string(bytes) + "\n";  // GDAL waits for it without end
    }
    const MemoryFile file(bytes, word == "gpkg" ? ".gpkg" : word == "dxf" ? ".dxf" : ".zip");
    if (word == "dxf") most_features_ = max_drawn;
    Vectors vectors;
    if (word != "shp") add_file(file.name(), word, vectors);
    else
      for (const std::string& part : shapefiles_in(bytes, file.name(), name_)) add_file(part, word, vectors);
    return vectors;
  }

 private:
  [[noreturn]] void bad(std::string code, const std::string& what) const {
    throw Error(ErrorKind::input, std::move(code), name_ + (element_.empty() ? "" : ", " + element_) + ": " + what);
  }

  /// GDAL waits for the rest of a line that holds one without end, and takes them for the end of other texts.
  void refuse_zero_bytes(std::string_view text) const {
    if (text.find('\0') != std::string_view::npos)
      bad("binary", "it holds zero bytes, which text does not; export it as text, a DXF file as ASCII DXF");
  }

  /// A view is a program that runs when it is read, and need not end. Looked for before SQLite sees the file: opening
  /// it reads tables that may be views.
  void refuse_programs(std::string_view bytes) const {
    const auto schema = sqlite_schema(bytes);
    if (!schema)
      bad("wrong-magic", "it cannot be read as gpkg; it is damaged, cut off or not in UTF-8, export it again");
    if (std::any_of(schema->begin(), schema->end(), runs_when_read))
      bad("views",
          "it holds views, generated columns or virtual tables, which are not read; export its layers to a new "
          "GeoPackage");
    const auto rows = sqlite_rows(bytes, "spatial_ref_sys");
    if (!rows) bad("wrong-magic", "its table of coordinate reference systems is damaged; export it again");
    for (const std::string& row : *rows) refuse_grid_files(row, name_);
  }

  void add_file(const std::string& file, const std::string& word, Vectors& vectors) {
    const char* drivers[] = {word == "gpkg" ? "GPKG" : word == "dxf" ? "DXF" : "ESRI Shapefile", nullptr};
    const DatasetHandle dataset(static_cast<GDALDataset*>(
        GDALOpenEx(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, drivers, nullptr, nullptr)));
    if (!dataset)
      bad("wrong-magic", word == "shp" ? "a shapefile in it cannot be read; it is damaged, or its .shx is not beside it"
                                       : "it cannot be read as " + word + "; it is damaged or cut off, send it again");
    for (int i = 0; i < dataset->GetLayerCount(); ++i)
      if (OGRLayer* layer = dataset->GetLayer(i)) add_layer(*layer, vectors);
  }

  void add_layer(OGRLayer& layer, Vectors& vectors) {
    if (const OGRSpatialReference* srs = layer.GetSpatialRef()) note_crs(*srs, vectors);
    const std::string layer_name = layer.GetName();
    layer.ResetReading();
    for (std::size_t n = 0;; ++n) {
      const OGRFeatureUniquePtr feature(layer.GetNextFeature());
      if (!feature) return;
      context_.stop_if_cancelled();
      element_ = "feature " + std::to_string(vectors.features.size());
      check_features(vectors, most_features_, name_);
      Feature row;
      for (int i = 0; i < feature->GetFieldCount(); ++i) add_property(*feature, i, row);
      if (const OGRGeometry* geometry = feature->GetGeometryRef()) add_shapes(*geometry, row);
      vectors.features.push_back(std::move(row));
    }
  }

  void note_crs(const OGRSpatialReference& srs, Vectors& vectors) const {
    char* text = nullptr;
    const char* options[] = {"FORMAT=WKT2_2019", nullptr};
    srs.exportToWkt(&text, options);
    const std::unique_ptr<char, void (*)(void*)> owned(text, CPLFree);
    const Crs crs = declared_crs(text ? text : "", name_, context_);
    if (!crs.known()) return;
    if (vectors.crs.known() && !vectors.crs.same_plan(crs))
      bad("mixed-crs", "its layers are in different coordinate reference systems; send the one that is meant");
    vectors.crs = crs;
  }

  static void add_property(const OGRFeature& feature, int i, Feature& row) {
    const OGRFieldDefn* field = feature.GetFieldDefnRef(i);
    nlohmann::json value;
    if (feature.IsFieldSetAndNotNull(i)) {
      const OGRFieldType type = field->GetType();
      if (type == OFTInteger || type == OFTInteger64)
        value = feature.GetFieldAsInteger64(i);
      else if (type == OFTReal)
        value = feature.GetFieldAsDouble(i);
      else if (type != OFTBinary)
        value = in_utf8(feature.GetFieldAsString(i));
    }
    row.properties[in_utf8(field->GetNameRef())] = std::move(value);
  }

  Point point(const OGRPoint& p) {
    if (++corners_ > max_corners) throw Error(ErrorKind::limit, "too-many-corners", name_ + ": too many corners");
    const double z = p.Is3D() ? p.getZ() : NAN;
    if (!std::isfinite(p.getX()) || !std::isfinite(p.getY()) || (p.Is3D() && !std::isfinite(z)))
      bad("bad-number", "a coordinate is not a finite number");
    return {p.getX(), p.getY(), z};
  }

  Line line(const OGRSimpleCurve& curve) {
    Line line;
    OGRPoint p;
    for (int i = 0; i < curve.getNumPoints(); ++i) {
      curve.getPoint(i, &p);
      line.push_back(point(p));
    }
    return line;
  }

  Line ring(const OGRSimpleCurve& curve) {
    Line ring = line(curve);
    if (ring.size() > 1 && ring.front().x == ring.back().x && ring.front().y == ring.back().y) ring.pop_back();
    if (ring.size() < 3) bad("bad-ring", "a ring has fewer than three corners");
    return ring;
  }

  void add_shapes(const OGRGeometry& geometry, Feature& feature) {
    if (geometry.IsEmpty()) return;
    if (geometry.hasCurveGeometry(true)) {
      const std::unique_ptr<OGRGeometry> straight(geometry.getLinearGeometry());
      if (!straight) bad("bad-geometry", "its curves cannot be drawn as lines");
      return add_shapes(*straight, feature);
    }
    switch (wkbFlatten(geometry.getGeometryType())) {
      case wkbPoint:
        feature.points.push_back(point(*geometry.toPoint()));
        return;
      case wkbLineString:
      case wkbLinearRing: {
        Line drawn = line(*geometry.toSimpleCurve());
        if (drawn.size() > 1) feature.lines.push_back(std::move(drawn));
        return;
      }
      case wkbPolygon:
      case wkbTriangle: {
        const OGRPolygon& source = *geometry.toPolygon();
        Polygon polygon{ring(*source.getExteriorRing()), {}};
        for (int i = 0; i < source.getNumInteriorRings(); ++i)
          polygon.holes.push_back(ring(*source.getInteriorRing(i)));
        feature.polygons.push_back(std::move(polygon));
        return;
      }
      case wkbMultiPoint:
      case wkbMultiLineString:
      case wkbMultiPolygon:
      case wkbGeometryCollection:
        for (const OGRGeometry* part : *geometry.toGeometryCollection()) add_shapes(*part, feature);
        return;
      case wkbTIN:
      case wkbPolyhedralSurface:
        for (const OGRGeometry* part : *geometry.toPolyhedralSurface()) add_shapes(*part, feature);
        return;
      default:
        bad("bad-geometry", "a geometry of this kind is not read; there are points, lines and polygons");
    }
  }

  const std::string& name_;
  Context& context_;
  std::string element_;
  std::size_t corners_ = 0, most_features_ = max_features;
};

// ---------------------------------------------------------------------------------------------------------- writing

[[noreturn]] void failed() { throw Error(ErrorKind::internal, "vectors", "the vector file could not be written"); }

OGRPoint ogr(const Point& p) { return std::isnan(p.z) ? OGRPoint(p.x, p.y) : OGRPoint(p.x, p.y, p.z); }

template <class Curve>
std::unique_ptr<Curve> ogr(const Line& line, bool ring) {
  auto curve = std::make_unique<Curve>();
  for (const Point& p : line) {
    const OGRPoint point = ogr(p);
    curve->addPoint(&point);
  }
  if (ring) curve->closeRings();
  return curve;
}

std::unique_ptr<OGRPolygon> ogr(const Polygon& polygon) {
  auto made = std::make_unique<OGRPolygon>();
  made->addRingDirectly(ogr<OGRLinearRing>(polygon.outer, true).release());
  for (const Line& hole : polygon.holes) made->addRingDirectly(ogr<OGRLinearRing>(hole, true).release());
  return made;
}

/// The shapes of one kind of a feature as one geometry; null when it has none.
std::unique_ptr<OGRGeometry> shapes_of(const Feature& f, OGRwkbGeometryType kind) {
  std::unique_ptr<OGRGeometryCollection> all;
  if (kind == wkbMultiPoint) {
    all = std::make_unique<OGRMultiPoint>();
    for (const Point& p : f.points) all->addGeometryDirectly(new OGRPoint(ogr(p)));
  } else if (kind == wkbMultiLineString) {
    all = std::make_unique<OGRMultiLineString>();
    for (const Line& line : f.lines) all->addGeometryDirectly(ogr<OGRLineString>(line, false).release());
  } else {
    all = std::make_unique<OGRMultiPolygon>();
    for (const Polygon& polygon : f.polygons) all->addGeometryDirectly(ogr(polygon).release());
  }
  if (all->IsEmpty()) return nullptr;
  return all;
}

/// The columns of all features: numbers where every value is one, else text.
std::vector<std::pair<std::string, OGRFieldType>> columns_of(const Vectors& vectors) {
  std::vector<std::string> names;
  for (const Feature& f : vectors.features)
    for (const auto& item : f.properties.items())
      if (std::find(names.begin(), names.end(), item.key()) == names.end()) names.push_back(item.key());
  std::vector<std::pair<std::string, OGRFieldType>> columns;
  for (const std::string& name : names) {
    bool numbers = true, whole = true;
    for (const Feature& f : vectors.features)
      if (const auto value = f.properties.find(name); value != f.properties.end() && !value->is_null()) {
        numbers = numbers && value->is_number();
        whole = whole && value->is_number_integer();
      }
    columns.emplace_back(name, whole ? OFTInteger64 : numbers ? OFTReal : OFTString);
  }
  return columns;
}

void set_properties(OGRFeature& row, const nlohmann::json& properties) {
  for (const auto& item : properties.items()) {
    const int column = row.GetFieldIndex(item.key().c_str());
    const nlohmann::json& value = item.value();
    if (column < 0 || value.is_null()) continue;
    if (value.is_number_integer())
      row.SetField(column, static_cast<GIntBig>(value.get<std::int64_t>()));
    else if (value.is_number())
      row.SetField(column, value.get<double>());
    else
      row.SetField(column, (value.is_string() ? value.get<std::string>() : value.dump()).c_str());
  }
}

void write_layer(GDALDataset& dataset, const Vectors& vectors, const std::string& name, OGRwkbGeometryType kind,
                 OGRSpatialReference* srs) {
  const bool any = std::any_of(vectors.features.begin(), vectors.features.end(),
                               [&](const Feature& f) { return shapes_of(f, kind) != nullptr; });
  if (!any) return;
  OGRLayer* layer = dataset.CreateLayer(name.c_str(), srs, wkbSetZ(kind), nullptr);
  if (!layer) failed();
  for (const auto& [column, type] : columns_of(vectors)) {
    OGRFieldDefn field(column.c_str(), type);
    layer->CreateField(&field);
  }
  for (const Feature& f : vectors.features) {
    auto geometry = shapes_of(f, kind);
    if (!geometry) continue;
    OGRFeature row(layer->GetLayerDefn());
    set_properties(row, f.properties);
    row.SetGeometryDirectly(geometry.release());
    if (layer->CreateFeature(&row) != OGRERR_NONE) failed();
  }
}

/// Drawing programs have lines one by one, their height the elevation of all corners, their kind a layer.
void write_drawing(GDALDataset& dataset, const Vectors& vectors) {
  OGRLayer* layer = dataset.CreateLayer("entities", nullptr, wkbUnknown, nullptr);
  if (!layer) failed();
  for (const Feature& f : vectors.features) {
    const auto level = f.properties.find("level");
    const bool flat = level != f.properties.end() && level->is_number();
    const auto kind = f.properties.find("kind");
    const bool named = kind != f.properties.end() && kind->is_string();
    const auto add = [&](std::unique_ptr<OGRGeometry> geometry) {
      if (flat && !geometry->Is3D()) geometry->set3D(true);
      OGRFeature row(layer->GetLayerDefn());
      if (named) row.SetField("Layer", kind->get<std::string>().c_str());
      row.SetGeometryDirectly(geometry.release());
      if (layer->CreateFeature(&row) != OGRERR_NONE) failed();
    };
    const auto lifted = [&](Line line) {
      for (Point& p : line)
        if (flat && std::isnan(p.z)) p.z = level->get<double>();
      return line;
    };
    for (const Point& p : f.points) add(std::make_unique<OGRPoint>(ogr(p)));
    for (const Line& line : f.lines) add(ogr<OGRLineString>(lifted(line), false));
    const auto add_ring = [&](Line ring) {
      if (!ring.empty()) ring.push_back(ring.front());
      add(ogr<OGRLineString>(lifted(std::move(ring)), false));
    };
    for (const Polygon& polygon : f.polygons) {
      add_ring(polygon.outer);
      for (const Line& hole : polygon.holes) add_ring(hole);
    }
  }
}

}  // namespace

Vectors read_ogr_vectors(std::string_view bytes, const std::string& word, const std::string& name, Context& context) {
  const ClosedGdal closed;
  register_vector_drivers();
  // Blocks of a drawing may insert blocks that insert blocks; nothing bounds what they unfold to.
  const CPLConfigOptionSetter no_blocks("DXF_INLINE_BLOCKS", "FALSE", false);
  Reader reader(name, context);
  return word == "wkt" ? reader.wkt(bytes) : reader.file(bytes, word);
}

std::string write_ogr_vectors(const Vectors& vectors, std::string_view word) {
  const ClosedGdal closed;
  register_vector_drivers();
  const bool gpkg = word == "gpkg";
  // A GeoPackage says when it was changed; the same result is to be the same bytes.
  const CPLConfigOptionSetter when("OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z", false);
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(gpkg ? "GPKG" : "DXF");
  if (!driver) failed();
  const MemoryFile file(gpkg ? ".gpkg" : ".dxf");
  {
    const DatasetHandle dataset(driver->Create(file.name().c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    if (!dataset) failed();
    if (gpkg) {
      std::unique_ptr<OGRSpatialReference> srs;
      if (vectors.crs.known() && !vectors.crs.local())
        srs = std::make_unique<OGRSpatialReference>(osr(vectors.crs.inside().definition));
      write_layer(*dataset, vectors, "points", wkbMultiPoint, srs.get());
      write_layer(*dataset, vectors, "lines", wkbMultiLineString, srs.get());
      write_layer(*dataset, vectors, "polygons", wkbMultiPolygon, srs.get());
    } else {
      write_drawing(*dataset, vectors);
    }
  }
  std::string bytes = file.contents();
  if (bytes.empty()) failed();
  return bytes;
}

}  // namespace terrane
