// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/vectors.hpp"
#include "ops/request.hpp"

// One description per operation, from which parsing, validation, command-line flags, help, the OGC process description,
// OpenAPI and the reference page are made. The list of all operations is ops/catalogue.cpp.
namespace terrane {

struct Parameter {
  enum class Type {
    number,
    integer,
    boolean,
    choice,
    text,
    crs,
    length,   // a number with an optional m, ft, ftUS
    numbers,  // a list 90,95,100 or a range from:to:step
    vectors,  // points, lines or polygons: a file, or written out
    json      // a JSON value that `schema` describes
  };
  std::string name;  // kebab-case
  Type type = Type::text;
  nlohmann::json default_value;  // null: no default, absent means not asked for
  std::optional<double> minimum, maximum;
  std::vector<std::string> choices;
  std::string unit;
  std::string sentence;
  nlohmann::json schema = nullptr;  // of Type::json
  bool corners_alone = false;  // of Type::vectors: lines and polygons stand for their corners, each a point by itself
};

struct InputSlot {
  std::string name = {};
  int min_occurs = 1, max_occurs = 1;  // max_occurs 0: any number
  bool takes_number = false;  // a level may stand in for a surface
  std::string sentence = {};
  std::string word = {};  // that may stand in for a surface: "boundary"
  bool lattice = false;  // a raster whose cells alone are of interest, and whose CRS is the result's; it stays one
};

/// One of several outputs.
struct OutputSlot {
  std::string name;
  nlohmann::json schema;
  std::string sentence;
};

/// A decoded input in the common frame, as an operation's run sees it.
struct Surface {
  std::string slot, name, sha256;
  /// In `run` a Raster only for a lattice, and points only where the operation takes them.
  std::variant<Tin, Raster, double, PointCloud> value;
  Crs crs;
  nlohmann::json source = nullptr;  // what a raster was before it was triangulated, for `info`; null for a TIN
  double max_error = 0;  // of the triangulation, measured over every sample in the result's CRS
  std::string word = {};  // the slot's word was given instead of a surface; the value is then a level without meaning
  /// When provenance is asked for: a TIN with the faces in the order of its file, of a raster the TIN made of it.
  std::shared_ptr<const Tin> given = {};
  std::string height_unit = {};  // what a raster says its heights are in, as Dataset has it; empty in `run`
  std::string level_unit = {};  // of a level, "m", "ft", "ftUS"; empty in `run`: it is in height units of the CRS

  bool level() const { return std::holds_alternative<double>(value); }
  bool points() const { return std::holds_alternative<PointCloud>(value); }
  const Tin& tin() const { return std::get<Tin>(value); }
};

struct Plan;
struct Outcome;  // what run returns: a TIN with its report parts, a picture, or a JSON report; ops/outcome.hpp

/// The values of an operation's parameters, as its run sees them.
struct Values {
  nlohmann::json plain;                    // by name, defaults filled in; of vectors what the certificate says of them
  std::map<std::string, Vectors> vectors;  // decoded and in the frame's CRS
  Crs crs = {};                            // the frame's
};

/// What kind of thing an operation returns, which decides the formats it can have unless it lists them itself.
enum class ResultKind { surface, report, table, picture, raster, vectors };  // table: a report that can also be CSV

/// How inputs are brought into the common frame before `run`.
struct Intake {
  bool check = true;  // mended and refused as the contract says; false: taken as it is (info, validate, convert)
  bool join_rasters = false;  // rasters on one lattice are joined before they are triangulated
  bool empty_allowed = false;
  bool raster_only = false;  // no TIN, which is one already
  bool points_allowed = false;
  bool every_sample = false;  // of a raster becomes a vertex: max-error is about what the operation does
};

/// One request of each operation, for the reference (where a test runs it) and for OpenAPI.
struct Example {
  /// For each input in order; left out: the DEMs west.tif and east.tif, which overlap. Logic has a.obj and b.obj.
  std::vector<std::string> files = {};
  std::vector<std::pair<std::string, std::string>> parameters = {};
};

struct Operation {
  std::string id = {}, title = {}, description = {};
  std::vector<InputSlot> inputs = {};
  std::vector<Parameter> parameters = {};  // its own; those of every operation are in common_parameters()
  std::vector<std::string> output_formats = {};  // every format it can have; the first is the default
  std::function<Outcome(std::vector<Surface>& inputs, const Values& values, Context&)> run = {};
  /// Instead of `run`, of an operation without any geometry: its inputs are whatever bytes they are, there is no frame,
  /// no common parameter and no certificate.
  std::function<Outcome(const Plan&, Context&)> run_plain = {};
  /// Where it has several; the outcome says which of them there are. Empty: one, named after the kind of result.
  std::vector<OutputSlot> outputs = {};

  ResultKind result = ResultKind::surface;
  Intake intake = {};
  /// Parameters and number of inputs that contradict each other. Throws Error{usage}. May be null.
  std::function<void(const nlohmann::json& parameters, const std::vector<InputPart>& inputs)> check = {};
  /// The kind of result where parameters change it (validate with repair); null: always `result`.
  std::function<ResultKind(const nlohmann::json& parameters)> result_with = {};

  Example example = {};

  ResultKind kind(const nlohmann::json& values) const { return result_with ? result_with(values) : result; }
};

/// Every operation, in the order of the documentation.
const std::vector<Operation>& catalogue();
/// Throws Error{no_such_process} listing what exists.
const Operation& find_operation(std::string_view id);
/// max-error, assume-crs, crs, target-crs, grid, format, threads.
const std::vector<Parameter>& common_parameters();
/// Those of them that an operation takes as they are; where max-error means something of its own it describes it itself.
/// None where there is no geometry.
std::vector<Parameter> common_parameters_of(const Operation& operation);

/// The words of `format` that a kind of result can have, the default first.
std::vector<std::string> formats_of(ResultKind kind);
/// The media type of an output format word: a format's own, application/json, text/csv, image/png.
std::string media_type_of(std::string_view format);

/// The OGC API - Processes description of one operation, and its summary.
nlohmann::json process_description(const Operation& operation);
nlohmann::json process_summary(const Operation& operation);
/// The whole service as OpenAPI 3.1; `openapi_yaml` is what is committed as openapi.yaml.
nlohmann::json openapi();
std::string openapi_yaml();
/// The same in the words of OpenAPI 3.0.
nlohmann::json openapi_30();
/// The reference page, docs/reference.md.
std::string reference_page();

}  // namespace terrane
