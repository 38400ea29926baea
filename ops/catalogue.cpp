// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/error.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"

namespace terrane {

const std::vector<Operation>& catalogue() {
  static const std::vector<Operation> all = {
      add(),
      subtract(),
      merge_operation(),
      seams_operation(),
      volume_operation(),
      logic_and(),
      logic_or(),
      logic_xor(),
      logic_nand(),
      logic_nor(),
      logic_not(),
      threshold(),
      quantize(),
      clip_operation(),
      synthesize_rectangle(),
      synthesize_circle(),
      synthesize_ellipse(),
      synthesize_polygon(),
      triangulate_operation(),
      rasterize_operation(),
      render(),
      profile(),
      sample(),
      contour(),
      simplify_operation(),
      transform_operation(),
      validate(),
      info(),
      convert(),
      echo(),
  };
  return all;
}

const Operation& find_operation(std::string_view id) {
  std::string list;
  for (const Operation& operation : catalogue()) {
    if (operation.id == id) return operation;
    list += (list.empty() ? "" : ", ") + operation.id;
  }
  throw Error(ErrorKind::no_such_process, "no-such-process",
              "there is no operation '" + std::string(id.substr(0, 80)) + "'; there are " + list);
}

const std::vector<Parameter>& common_parameters() {
  static const std::vector<Parameter> all = described<CommonParameters>();
  return all;
}

namespace {

/// By any parameters.
bool can_return_surface(const Operation& operation) {
  const std::string word = "ply";
  return operation.result == ResultKind::surface ||
         std::find(operation.output_formats.begin(), operation.output_formats.end(), word) !=
             operation.output_formats.end();
}

}  // namespace

std::vector<Parameter> common_parameters_of(const Operation& operation) {
  std::vector<Parameter> list;
  if (operation.run_plain) return list;
  const bool surface = can_return_surface(operation);
  for (const Parameter& common : common_parameters())
    if ((surface || common.name != "provenance") &&
        std::none_of(operation.parameters.begin(), operation.parameters.end(),
                     [&](const Parameter& own) { return own.name == common.name; }))
      list.push_back(common);
  return list;
}

std::vector<std::string> formats_of(ResultKind kind) {
  if (kind == ResultKind::report) return {"json"};
  if (kind == ResultKind::table) return {"json", "csv"};
  if (kind == ResultKind::picture) return {"png"};
  if (kind == ResultKind::raster) return {"tif", "asc"};
  if (kind == ResultKind::vectors) return {"geojson", "gpkg", "dxf"};
  std::vector<std::string> words;
  for (const Format& format : formats())
    if (format.write) words.push_back(format.name);
  // Terrane JSON is what comes when nothing says otherwise.
  std::stable_partition(words.begin(), words.end(), [](const std::string& word) { return word == "json"; });
  return words;
}

std::string media_type_of(std::string_view word) {
  if (word == "csv") return "text/csv";
  if (word == "png") return "image/png";
  if (word == "geojson") return "application/geo+json";
  if (word == "gpkg") return "application/geopackage+sqlite3";
  if (word == "dxf") return "image/vnd.dxf";
  if (const Format* format = format_named(word)) return format->media_type;
  return "application/json";
}

}  // namespace terrane
