// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "ops/operation.hpp"
#include "ops/outcome.hpp"

// Each operation declares a struct of parameters with one function that visits them; describing, parsing and filling
// all
// come from that visit, so nothing is said twice.
namespace terrane {

/// A length as it was asked for. Without a unit it is in the units of the CRS (metres where those are degrees).
struct Length {
  double value = 0;
  std::string unit;  // "", "m", "ft", "ftUS"

  /// In a unit of that many metres.
  double in(double metres_per_unit) const;
  /// "5 ft", "0.25"; none where the text is no length.
  static std::optional<Length> read(std::string_view text);
  /// The same, but throws Error{usage} naming the parameter.
  static Length parse(std::string_view text, const std::string& parameter);
  nlohmann::json json() const;  // a number, or "5ft"
  static Length of(const nlohmann::json& value);
};

/// Visits the parameters of a struct: describes them, or fills them from a plan's values.
class Fields {
 public:
  struct Bounds {
    std::optional<double> minimum = {}, maximum = {};
  };

  explicit Fields(std::vector<Parameter>& described) : described_(&described) {}
  explicit Fields(const nlohmann::json& values, const std::map<std::string, Vectors>* vectors = nullptr)
      : values_(&values), vectors_(vectors) {}

  void number(const char* name, double& field, Bounds bounds, const char* unit, const char* sentence);
  void number(const char* name, std::optional<double>& field, Bounds bounds, const char* unit, const char* sentence);
  void integer(const char* name, std::optional<long>& field, Bounds bounds, const char* sentence);
  void integer(const char* name, long& field, Bounds bounds, const char* sentence);
  void boolean(const char* name, bool& field, const char* sentence);
  void length(const char* name, Length& field, Bounds bounds, const char* sentence);
  /// Without a default.
  void length(const char* name, std::optional<Length>& field, Bounds bounds, const char* sentence);
  void text(const char* name, std::string& field, const char* sentence);
  void crs(const char* name, std::string& field, const char* sentence);
  void numbers(const char* name, std::vector<double>& field, const char* sentence);
  /// Given for a check of parameters, the field is only known to be empty or not.
  void vectors(const char* name, std::optional<Vectors>& field, const char* sentence);
  /// Vectors of which the corners alone are asked for.
  void points(const char* name, std::optional<Vectors>& field, const char* sentence);
  void json(const char* name, nlohmann::json& field, const nlohmann::json& schema, const char* sentence);

  template <class E>
  void choice(const char* name, E& field, std::initializer_list<std::pair<const char*, E>> words,
              const char* sentence) {
    if (described_) {
      Parameter p{name, Parameter::Type::choice, nullptr, {}, {}, {}, "", sentence};
      for (const auto& [word, value] : words) {
        p.choices.push_back(word);
        if (value == field) p.default_value = word;
      }
      described_->push_back(std::move(p));
    } else if (const nlohmann::json* value = find(name)) {
      for (const auto& [word, meaning] : words)
        if (*value == word) field = meaning;
    }
  }

 private:
  const nlohmann::json* find(const char* name) const;
  void describe(Parameter parameter) { described_->push_back(std::move(parameter)); }

  std::vector<Parameter>* described_ = nullptr;
  const nlohmann::json* values_ = nullptr;
  const std::map<std::string, Vectors>* vectors_ = nullptr;
};

/// The parameters of a struct, described; its members hold the defaults.
template <class P>
std::vector<Parameter> described() {
  std::vector<Parameter> list;
  Fields fields(list);
  P{}.visit(fields);
  return list;
}

/// A struct of parameters filled from a plan's values.
template <class P>
P filled(const nlohmann::json& values, const std::map<std::string, Vectors>* vectors = nullptr) {
  P parameters;
  Fields fields(values, vectors);
  parameters.visit(fields);
  return parameters;
}

/// An operation whose run takes its own struct of parameters.
template <class P>
Operation operation(Operation description, Outcome (*run)(std::vector<Surface>&, const P&, Context&)) {
  description.parameters = described<P>();
  description.run = [run](std::vector<Surface>& inputs, const Values& values, Context& context) {
    return run(inputs, filled<P>(values.plain, &values.vectors), context);
  };
  if (description.output_formats.empty()) description.output_formats = formats_of(description.result);
  return description;
}

/// The same for a run that makes its result from nothing, in the CRS that was asked for.
template <class P>
Operation operation(Operation description, Outcome (*run)(std::vector<Surface>&, const P&, const Crs&, Context&)) {
  description.parameters = described<P>();
  description.run = [run](std::vector<Surface>& inputs, const Values& values, Context& context) {
    return run(inputs, filled<P>(values.plain, &values.vectors), values.crs, context);
  };
  if (description.output_formats.empty()) description.output_formats = formats_of(description.result);
  return description;
}

/// The parameters that every operation takes.
struct CommonParameters {
  Length max_error, grid;
  std::string assume_crs, crs, target_crs, format;
  long threads = 0;
  bool provenance = false;
  void visit(Fields& fields);
};

/// Text as the value a parameter takes. Throws Error{usage} saying what is expected.
nlohmann::json parse_parameter(const Parameter& parameter, std::string_view text);

/// "EPSG:25831", or "t3.tif:EPSG:4326;b:local:m": which CRS is meant for an input. `inputs` empty in the pair: for all.
/// `names` are the words that may stand before the colon.
struct CrsRule {
  std::string input;
  std::string crs;
};
std::vector<CrsRule> parse_crs_rules(std::string_view text, const std::vector<std::string>& names);

/// "90,95,100" or "90:110:5", at most 10000 of them. Throws Error{usage} naming the parameter.
std::vector<double> parse_numbers(std::string_view text, const std::string& parameter);

/// A number that fills the whole text, and is finite.
std::optional<double> parse_number(std::string_view text);

}  // namespace terrane
