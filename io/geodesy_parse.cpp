// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <memory>

#include "core/error.hpp"
#include "io/gdal_library.hpp"
#include "io/geodesy_osr.hpp"
#include "io/text.hpp"
#include "io/utf8.hpp"

// Text to CRS. OSR understands far more than we let it see: file names, URLs, PROJ strings with grids of one's choice.
namespace terrane {

namespace {

constexpr std::size_t max_text = 100'000;
constexpr int max_nesting = 40;

[[noreturn]] void bad_crs(const std::string& why) {
  throw Error(ErrorKind::usage, "bad-crs",
              why +
                  "; give EPSG:25831, EPSG:25831+5773, WKT, PROJJSON, an opengis.net URI, "
                  "local:m, local:ft or local:ftUS");
}

bool all(std::string_view text, bool (*test)(char)) {
  return !text.empty() && std::all_of(text.begin(), text.end(), test);
}
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_word(char c) { return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

std::string upper(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return out;
}

/// The code in ".../def/crs/EPSG/0/25831" or "urn:ogc:def:crs:EPSG::25831", split at `separator`.
std::string uri_code(std::string_view path, char separator) {
  const std::size_t first = path.find(separator);
  if (first == std::string_view::npos) return "";
  const std::size_t second = path.find(separator, first + 1);
  if (second == std::string_view::npos) return "";
  return register_code(std::string(path.substr(0, first)) + ":" + std::string(path.substr(second + 1)));
}

std::string uri(std::string_view text) {
  const std::string small = lower(text);
  if (small.starts_with("urn:ogc:def:crs:") || small.starts_with("urn:x-ogc:def:crs:"))
    return uri_code(text.substr(small.find(":crs:") + 5), ':');
  const std::size_t host = small.find("opengis.net/def/crs");
  const std::string_view scheme = std::string_view(small).substr(0, host);
  if (host == std::string::npos ||
      (scheme != "http://" && scheme != "https://" && scheme != "http://www." && scheme != "https://www."))
    return "";
  const std::string_view path = text.substr(host + 19);
  if (path.starts_with('/')) return uri_code(path.substr(1), '/');
  const std::string_view lead = "-compound?1=";
  const std::size_t second = path.find("&2=");
  if (!path.starts_with(lead) || second == std::string_view::npos) return "";
  const std::string plan = uri(path.substr(lead.size(), second - lead.size())), heights = uri(path.substr(second + 3));
  if (!plan.starts_with("EPSG:") || !heights.starts_with("EPSG:") || plan.find('+') != std::string::npos) return "";
  return register_code(plan + "+" + heights.substr(5));
}

bool is_wkt(std::string_view text) {
  constexpr std::array words = {"GEOGCS",       "PROJCS",  "COMPD_CS",    "LOCAL_CS",       "GEOGCRS",
                                "GEODCRS",      "PROJCRS", "COMPOUNDCRS", "GEODETICCRS",    "GEOGRAPHICCRS",
                                "PROJECTEDCRS", "ENGCRS",  "BOUNDCRS",    "ENGINEERINGCRS", "GEOCCS"};
  const std::string_view word = trimmed(text.substr(0, text.find_first_of("[(")));
  return word.size() < text.size() && std::find(words.begin(), words.end(), upper(word)) != words.end();
}

bool nested_too_deep(std::string_view text) {
  int depth = 0, deepest = 0;
  for (char c : text) {
    if (c == '[' || c == '(' || c == '{') deepest = std::max(deepest, ++depth);
    if (c == ']' || c == ')' || c == '}') --depth;
  }
  return deepest > max_nesting;
}

bool import_text(OGRSpatialReference& srs, const std::string& text) {
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const bool done = is_wkt(text)
                        ? srs.importFromWkt(text.c_str()) == OGRERR_NONE
                        : srs.SetFromUserInput(
                              text.c_str(), OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get()) == OGRERR_NONE;
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return done;
}

}  // namespace

std::string register_code(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return "";
  const std::string authority = upper(text.substr(0, colon));
  constexpr std::array known = {"EPSG", "ESRI", "OGC", "IGNF"};
  if (std::find(known.begin(), known.end(), authority) == known.end()) return "";
  const std::string_view number = text.substr(colon + 1);
  const std::size_t plus = number.find('+');
  if (number.size() > 40 || !all(number.substr(0, plus), is_word)) return "";
  if (plus != std::string_view::npos && (authority != "EPSG" || !all(number.substr(plus + 1), is_digit))) return "";
  if (authority == "EPSG" && !all(number.substr(0, plus), is_digit)) return "";
  return authority + ":" + std::string(number);
}

void load_geodesy() { load_gdal(); }

bool names_files(std::string_view text) {
  std::string small = lower(text);
  constexpr std::string_view harmless = "nadgrids=@null";  // how Web Mercator was once written
  for (std::size_t at; (at = small.find(harmless)) != std::string::npos;) small.erase(at, harmless.size());
  constexpr std::array words = {"grids=",   "init=",  "+file",       "file=",    "parameterfile",
                                "+catalog", "+model", "proj4_grids", "pipeline", "proj-based"};
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return small.find(word) != std::string::npos; });
}

Crs Crs::parse(std::string_view given) {
  const std::string_view text = trimmed(given);
  if (text.empty()) bad_crs("the coordinate reference system is empty");
  if (text.size() > max_text) bad_crs("the coordinate reference system is longer than 100,000 characters");
  if (text.find('\0') != std::string_view::npos) bad_crs("the coordinate reference system holds a zero byte");
  Crs crs;
  if (text.starts_with("local:")) {
    const std::string_view unit = text.substr(6);
    if (unit != "m" && unit != "ft" && unit != "ftUS") bad_crs("a local frame is local:m, local:ft or local:ftUS");
    crs.impl_ = Impl::local_frame(unit);
    return crs;
  }
  std::string definition = register_code(text);
  const bool free_text = is_wkt(text) || text.front() == '{';
  if (definition.empty()) definition = uri(text);
  if (definition.empty() && free_text) definition = in_utf8(std::string(text));
  if (definition.empty()) bad_crs("the text is neither a code nor WKT, PROJJSON or an opengis.net URI");
  if (free_text && nested_too_deep(text)) bad_crs("the coordinate reference system is nested too deep");
  if (free_text && names_files(text))
    bad_crs("the coordinate reference system names grid files or PROJ pipelines, which is not allowed");
  const Quiet quiet;
  OGRSpatialReference srs;
  if (!import_text(srs, definition))
    bad_crs(free_text ? "the coordinate reference system is not understood" : "the register has no " + definition);
  // PROJJSON names a file without a keyword of its own; in WKT it has one.
  char* wkt = nullptr;
  const char* options[] = {"FORMAT=WKT2_2019", nullptr};
  const bool exported = srs.exportToWkt(&wkt, options) == OGRERR_NONE && wkt;
  const bool with_file = exported && lower(wkt).find("parameterfile") != std::string::npos;
  CPLFree(wkt);
  if (with_file) bad_crs("the coordinate reference system names grid files, which is not allowed");
  crs.impl_ = Impl::of(std::move(srs), free_text ? "" : definition);
  return crs;
}

}  // namespace terrane
