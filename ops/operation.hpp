// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "ops/request.hpp"

// One description per operation, from which parsing, validation, command-line flags, help, the OGC process description,
// OpenAPI and the reference page are made. The list of all operations is ops/catalogue.cpp.
namespace terrane {

struct Parameter {
  enum class Type { number, integer, boolean, choice, text, crs, length };  // length: a number with an optional m, ft, ftUS
  std::string name;  // kebab-case
  Type type = Type::text;
  nlohmann::json default_value;  // null: no default, absent means not asked for
  std::optional<double> minimum, maximum;
  std::vector<std::string> choices;
  std::string unit;
  std::string sentence;
};

struct InputSlot {
  std::string name;
  int min_occurs = 1, max_occurs = 1;  // max_occurs 0: any number
  bool takes_number = false;           // a level may stand in for a surface
  std::string sentence;
};

/// A decoded input in the common frame, as an operation's run sees it.
struct Surface {
  std::string slot, name, sha256;
  std::variant<Tin, Raster, double> value;
  Crs crs;
};

struct Outcome;  // what run returns: a TIN with its report parts, a picture, or a JSON report; ops/outcome.hpp

struct Operation {
  std::string id, title, description;
  std::vector<InputSlot> inputs;
  std::vector<Parameter> parameters;  // its own; those of every operation are in common_parameters()
  std::vector<std::string> output_formats;  // the first is the default
  std::function<Outcome(std::vector<Surface>& inputs, const nlohmann::json& parameters, Context&)> run;
};

/// Every operation, in the order of the documentation.
const std::vector<Operation>& catalogue();
/// Throws Error{no_such_process} listing what exists.
const Operation& find_operation(std::string_view id);
/// max-error, assume-crs, crs, target-crs, grid, format, threads, provenance.
const std::vector<Parameter>& common_parameters();

/// The OGC API - Processes description of one operation, and its summary.
nlohmann::json process_description(const Operation& operation);
nlohmann::json process_summary(const Operation& operation);
/// The whole service as OpenAPI 3.1; `openapi_yaml` is what is committed as openapi.yaml.
nlohmann::json openapi();
std::string openapi_yaml();
/// The reference page, docs/reference.md.
std::string reference_page();

}  // namespace terrane
