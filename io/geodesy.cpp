// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/geodesy.hpp"

#include <cmath>
#include <numbers>

#include <cpl_conv.h>
#include <ogr_srs_api.h>

#include "core/error.hpp"
#include "io/geodesy_osr.hpp"

namespace terrane {

namespace {

[[noreturn]] void bad_crs(const std::string& why) {
  throw Error(ErrorKind::usage, "bad-crs",
              "this is no coordinate reference system we can use: " + why +
                  "; give EPSG:25831, EPSG:25831+5773, WKT, PROJJSON, an opengis.net URI, "
                  "local:m, local:ft or local:ftUS");
}

constexpr double us_foot = 1200.0 / 3937.0;

std::string unit_name(double metres, const char* name) {
  if (std::fabs(metres - 1) < 1e-12) return "m";
  if (std::fabs(metres - 0.3048) < 1e-9) return "ft";
  if (std::fabs(metres - us_foot) < 1e-9) return "ftUS";
  return name ? name : "unknown";
}

/// Units come as rounded decimals; the foot we know is the exact one.
double exact_unit(double metres) {
  const std::string name = unit_name(metres, nullptr);
  return name == "ft" ? 0.3048 : name == "ftUS" ? us_foot : name == "m" ? 1 : metres;
}

std::string exported(const OGRSpatialReference& srs, const char* format) {
  const std::string option = std::string("FORMAT=") + format;
  const char* options[] = {option.c_str(), "MULTILINE=NO", nullptr};
  char* text = nullptr;
  const bool done = srs.exportToWkt(&text, options) == OGRERR_NONE;
  std::string out = done && text ? text : "";
  CPLFree(text);
  return out;
}

/// WKT 2 that says the same of itself once it is read: the first export of what came as WKT 1 may spell axes otherwise.
std::string settled_wkt(const OGRSpatialReference& srs) {
  std::string wkt = exported(srs, "WKT2_2019");
  for (int round = 0; round < 3; ++round) {
    OGRSpatialReference again;
    if (again.importFromWkt(wkt.c_str()) != OGRERR_NONE) break;
    std::string next = exported(again, "WKT2_2019");
    if (next.empty() || next == wkt) break;
    wkt = std::move(next);
  }
  return wkt;
}

std::string code_of(const OGRSpatialReference& srs) {
  const char* name = srs.GetAuthorityName(nullptr);
  const char* code = srs.GetAuthorityCode(nullptr);
  if (name && code) return std::string(name) + ":" + code;
  if (!srs.IsCompound()) return "";
  OGRSpatialReference horizontal = srs;
  horizontal.StripVertical();
  const char* vertical = srs.GetAuthorityCode("VERT_CS");
  const char* vertical_name = srs.GetAuthorityName("VERT_CS");
  const std::string plan = code_of(horizontal);
  if (!plan.starts_with("EPSG:") || !vertical || !vertical_name || std::string_view(vertical_name) != "EPSG") return "";
  return plan + "+" + vertical;
}

bool same(const OGRSpatialReference& a, const OGRSpatialReference& b) {
  const char* options[] = {"CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS", "IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES",
                           "IGNORE_COORDINATE_EPOCH=YES", nullptr};
  return a.IsSame(&b, options);
}

/// The code a CRS carries, when the register agrees on its meaning: WKT with a code and other numbers exists.
std::string verified_code(const OGRSpatialReference& srs) {
  const std::string code = register_code(code_of(srs));
  if (code.empty()) return "";
  OGRSpatialReference registered;
  registered.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (registered.SetFromUserInput(code.c_str(), OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get()) !=
      OGRERR_NONE)
    return "";
  return same(srs, registered) ? code : "";
}

std::string datum_name(const OGRSpatialReference& srs) {
  const char* name = srs.GetAttrValue("DATUM");
  if (!name) name = srs.GetAttrValue("ENSEMBLE");
  return name ? name : "unnamed";
}

}  // namespace

OGRSpatialReference osr(const std::string& definition) {
  static const bool offline = (OSRSetPROJEnableNetwork(false), true);
  (void)offline;
  OGRSpatialReference srs;
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (srs.SetFromUserInput(definition.c_str(), OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get()) !=
      OGRERR_NONE)
    throw Error(ErrorKind::internal, "crs", "a coordinate reference system was understood once and is not any more");
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return srs;
}

std::shared_ptr<const Crs::Impl> Crs::Impl::local_frame(std::string_view unit) {
  auto impl = std::make_shared<Impl>();
  impl->local = true;
  impl->length_unit = impl->height_unit = unit;
  impl->metres_per_length_unit = impl->metres_per_height_unit = unit == "ft" ? 0.3048 : unit == "ftUS" ? us_foot : 1;
  impl->id = "local:" + std::string(unit);
  impl->name = "local frame in " + std::string(unit == "ft" ? "feet" : unit == "ftUS" ? "US survey feet" : "metres");
  return impl;
}

std::shared_ptr<const Crs::Impl> Crs::Impl::of(OGRSpatialReference srs, const std::string& given) {
  // All that is said of a CRS is read from its own WKT 2, so that its id says the same: names in WKT 1 may be spelt so
  // that they are recognised only on the way there.
  const std::string wkt = settled_wkt(srs);
  if (OGRSpatialReference settled; given.empty() && settled.importFromWkt(wkt.c_str()) == OGRERR_NONE) {
    settled.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    srs = std::move(settled);
  }
  const char* name = nullptr;
  if (srs.IsLocal()) {
    const double unit = srs.GetLinearUnits(&name);
    const std::string word = unit_name(unit, "");
    if (word.empty()) bad_crs("a local frame in a unit other than m, ft and ftUS");
    return local_frame(word);
  }
  const bool projected = srs.IsProjected();
  if (srs.IsGeocentric() || !(projected || srs.IsGeographic()))
    bad_crs("it has no map plane (neither projected nor longitude and latitude)");
  if (srs.IsDerivedGeographic()) bad_crs("longitude and latitude on a rotated pole");
  auto impl = std::make_shared<Impl>();
  impl->geographic = !projected;
  if (impl->geographic && std::fabs(srs.GetAngularUnits(&name) - std::numbers::pi / 180) > 1e-12)
    bad_crs("its angles are not degrees; transform the data to degrees first");
  if (projected) {
    const double unit = srs.GetLinearUnits(&name);
    impl->length_unit = unit_name(unit, name);
    impl->metres_per_length_unit = exact_unit(unit);
    impl->height_unit = impl->length_unit;
    impl->metres_per_height_unit = impl->metres_per_length_unit;
  } else {
    impl->length_unit = "degree";
  }
  OGRSpatialReference horizontal = srs;
  if (srs.IsCompound()) {
    const char* datum = srs.GetAttrValue("VERT_DATUM");
    if (!datum) datum = srs.GetAttrValue("VDATUM");
    OGRAxisOrientation direction = OAO_Up;
    srs.GetAxis("VERT_CS", 0, &direction);
    if (direction == OAO_Down) bad_crs("its heights are depths, counted downwards");
    const double unit = srs.GetTargetLinearUnits("VERT_CS", &name);
    impl->vertical_datum = datum ? datum : "unknown";
    impl->height_unit = unit_name(unit, name);
    impl->metres_per_height_unit = exact_unit(unit);
    horizontal.StripVertical();
  } else if (srs.GetAxesCount() == 3) {
    impl->ellipsoidal_heights = true;
    impl->vertical_datum = "ellipsoid of " + datum_name(srs);
  }
  if (horizontal.GetAxesCount() == 3) horizontal.DemoteTo2D(nullptr);
  impl->semi_major = horizontal.GetSemiMajor();
  impl->inverse_flattening = horizontal.GetInvFlattening();
  impl->name = srs.GetName() ? srs.GetName() : "";
  impl->wkt = wkt;
  impl->wkt1 = exported(srs, "WKT1_GDAL");
  impl->horizontal_wkt = settled_wkt(horizontal);
  if (impl->wkt.empty() || impl->horizontal_wkt.empty()) bad_crs("it cannot be written as WKT");
  const std::string code = given.empty() ? verified_code(srs) : given;
  const std::string plan = !given.empty() && horizontal.GetAxesCount() == srs.GetAxesCount() && !srs.IsCompound()
                               ? given
                               : verified_code(horizontal);
  impl->id = code.empty() ? impl->wkt : code;
  impl->definition = impl->id;
  impl->horizontal_definition = plan.empty() ? impl->horizontal_wkt : plan;
  return impl;
}

bool Crs::geographic() const { return impl_ && impl_->geographic; }
bool Crs::local() const { return impl_ && impl_->local; }
std::string Crs::id() const { return impl_ ? impl_->id : ""; }
std::string Crs::name() const { return impl_ ? impl_->name : "unknown"; }
std::string Crs::wkt() const { return impl_ ? impl_->wkt : ""; }
std::string Crs::wkt1() const { return impl_ ? impl_->wkt1 : ""; }
std::string Crs::vertical_datum() const { return impl_ ? impl_->vertical_datum : "unknown"; }
std::string Crs::length_unit() const { return impl_ ? impl_->length_unit : "m"; }
std::string Crs::height_unit() const { return impl_ ? impl_->height_unit : "m"; }
double Crs::metres_per_length_unit() const { return impl_ ? impl_->metres_per_length_unit : 1; }
double Crs::metres_per_height_unit() const { return impl_ ? impl_->metres_per_height_unit : 1; }

Crs Crs::horizontal() const { return !impl_ || impl_->local ? *this : parse(impl_->horizontal_definition); }

bool Crs::same_plan(const Crs& other) const {
  if (!impl_ || !other.impl_) return impl_ == other.impl_;
  if (impl_ == other.impl_) return true;
  if (impl_->local || other.impl_->local) return impl_->id == other.impl_->id;
  if (impl_->horizontal_definition == other.impl_->horizontal_definition) return true;
  if (impl_->geographic != other.impl_->geographic || impl_->length_unit != other.impl_->length_unit) return false;
  const Quiet quiet;
  return same(osr(impl_->horizontal_definition), osr(other.impl_->horizontal_definition));
}

}  // namespace terrane
