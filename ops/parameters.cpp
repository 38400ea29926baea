// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/parameters.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/shortest.hpp"
#include "io/utf8.hpp"
#include "ops/json_value.hpp"

namespace terrane {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

[[noreturn]] void refuse(const Parameter& p, std::string_view text, const std::string& expected) {
  throw Error(ErrorKind::usage, "bad-parameter",
              "parameter '" + p.name + "' is '" + std::string(text.substr(0, 80)) + "'; it takes " + expected);
}

std::string range_text(const Parameter& p) {
  std::string text;
  if (p.minimum) text += " from " + shortest(*p.minimum);
  if (p.maximum) text += " up to " + shortest(*p.maximum);
  return text;
}

void check_range(const Parameter& p, double value, std::string_view text, const std::string& what) {
  if ((p.minimum && value < *p.minimum) || (p.maximum && value > *p.maximum)) refuse(p, text, what + range_text(p));
}

double metres(std::string_view unit) { return unit == "ft" ? 0.3048 : unit == "ftUS" ? 1200.0 / 3937.0 : 1.0; }

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  text = trimmed(text);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

double Length::in(double metres_per_unit) const {
  return unit.empty() ? value : value * metres(unit) / metres_per_unit;
}

std::optional<Length> Length::read(std::string_view text) {
  std::string_view number = trimmed(text);
  std::string unit;
  for (const char* word : {"ftUS", "ft", "m"})
    if (unit.empty() && number.ends_with(word)) {
      unit = word;
      number.remove_suffix(unit.size());
    }
  if (const auto value = parse_number(number)) return Length{*value, unit};
  return {};
}

Length Length::parse(std::string_view text, const std::string& parameter) {
  if (const auto length = read(text)) return *length;
  throw Error(ErrorKind::usage, "bad-parameter",
              "parameter '" + parameter + "' is '" + std::string(text.substr(0, 80)) +
                  "'; it takes a number, with or without one of the units m, ft, ftUS");
}

nlohmann::json Length::json() const {
  return unit.empty() ? nlohmann::json(value) : nlohmann::json(shortest(value) + unit);
}

Length Length::of(const nlohmann::json& value) {
  return value.is_string() ? parse(value.get_ref<const std::string&>(), "length") : Length{value.get<double>(), ""};
}

nlohmann::json parse_parameter(const Parameter& p, std::string_view text) {
  switch (p.type) {
    case Parameter::Type::number: {
      const auto value = parse_number(text);
      if (!value) refuse(p, text, "a number" + range_text(p));
      check_range(p, *value, text, "a number");
      return *value;
    }
    case Parameter::Type::integer: {
      long value = 0;
      const std::string_view word = trimmed(text);
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (error != std::errc{} || end != word.data() + word.size()) refuse(p, text, "a whole number" + range_text(p));
      check_range(p, static_cast<double>(value), text, "a whole number");
      return value;
    }
    case Parameter::Type::boolean:
      if (text == "true" || text == "1" || text == "yes") return true;
      if (text == "false" || text == "0" || text == "no") return false;
      refuse(p, text, "true or false");
    case Parameter::Type::choice: {
      if (std::find(p.choices.begin(), p.choices.end(), text) != p.choices.end()) return std::string(text);
      std::string list;
      for (const std::string& word : p.choices) list += (list.empty() ? "" : ", ") + word;
      refuse(p, text, "one of " + list);
    }
    case Parameter::Type::length: {
      const Length value = Length::parse(text, p.name);
      check_range(p, value.value, text, "a length");
      return value.json();
    }
    case Parameter::Type::numbers: return parse_numbers(text, p.name);
    case Parameter::Type::vectors:
      if (!vector_format(text))
        refuse(p, text,
               "GeoJSON, WKT, a GeoPackage, a zipped Shapefile, DXF, a table whose first line names x and y, or "
               "coordinates x,y;x,y");
      return nullptr;  // what is kept of them is the plan's
    case Parameter::Type::json: return parse_json_value(text, p.schema, "parameter '" + p.name + "'");
    case Parameter::Type::crs:
    case Parameter::Type::text: {
      std::string word(trimmed(text));
      if (!is_utf8(word))
        throw Error(ErrorKind::usage, "bad-parameter", "parameter '" + p.name + "' is not in UTF-8");
      return word;
    }
  }
  return nullptr;
}

std::vector<double> parse_numbers(std::string_view text, const std::string& parameter) {
  const auto wrong = [&](const char* why) -> Error {
    return {ErrorKind::usage, "bad-parameter",
            "parameter '" + parameter + "' is '" + std::string(text.substr(0, 80)) + "'; " + why};
  };
  constexpr std::size_t most = 10000;
  const auto split = [&](char mark) {
    std::vector<double> values;
    std::size_t begin = 0;
    while (begin <= text.size()) {
      const std::size_t end = std::min(text.find(mark, begin), text.size());
      const auto value = parse_number(text.substr(begin, end - begin));
      if (!value) throw wrong("it takes numbers separated by commas, or from:to:step");
      if (values.size() == most) throw wrong("that is more than 10000 numbers");
      values.push_back(*value);
      begin = end + 1;
    }
    return values;
  };
  if (text.find(':') == std::string_view::npos) return split(',');
  const auto range = split(':');
  if (range.size() != 3 || range[2] <= 0 || range[1] < range[0]) throw wrong("a range is from:to:step, upwards");
  const double steps = std::floor((range[1] - range[0]) / range[2] * (1 + 1e-12));
  if (!(steps < most)) throw wrong("that is more than 10000 numbers");
  std::vector<double> values;
  for (int i = 0; i <= steps; ++i) values.push_back(range[0] + i * range[2]);
  return values;
}

std::vector<CrsRule> parse_crs_rules(std::string_view text, const std::vector<std::string>& names) {
  std::vector<CrsRule> rules;
  while (!trimmed(text).empty()) {
    const std::size_t end = text.find(';');
    std::string_view word = trimmed(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    if (word.empty()) continue;
    CrsRule rule;
    for (const std::string& name : names)  // the longest name wins: "a.tif" before "a"
      if (name.size() > rule.input.size() && word.size() > name.size() && word.starts_with(name) &&
          word[name.size()] == ':')
        rule.input = name;
    rule.crs = trimmed(word.substr(rule.input.empty() ? 0 : rule.input.size() + 1));
    rules.push_back(std::move(rule));
  }
  return rules;
}

const nlohmann::json* Fields::find(const char* name) const {
  const auto it = values_->find(name);
  return it == values_->end() || it->is_null() ? nullptr : &*it;
}

void Fields::number(const char* name, double& field, Bounds bounds, const char* unit, const char* sentence) {
  if (described_)
    describe({name, Parameter::Type::number, field, bounds.minimum, bounds.maximum, {}, unit, sentence});
  else if (const auto* value = find(name))
    field = value->get<double>();
}

void Fields::number(const char* name, std::optional<double>& field, Bounds bounds, const char* unit,
                    const char* sentence) {
  if (described_)
    describe({name, Parameter::Type::number, nullptr, bounds.minimum, bounds.maximum, {}, unit, sentence});
  else if (const auto* value = find(name))
    field = value->get<double>();
}

void Fields::integer(const char* name, std::optional<long>& field, Bounds bounds, const char* sentence) {
  if (described_)
    describe({name,
              Parameter::Type::integer,
              field ? nlohmann::json(*field) : nlohmann::json(),
              bounds.minimum,
              bounds.maximum,
              {},
              "",
              sentence});
  else if (const auto* value = find(name))
    field = value->get<long>();
}

void Fields::integer(const char* name, long& field, Bounds bounds, const char* sentence) {
  std::optional<long> value = field;
  integer(name, value, bounds, sentence);
  field = *value;
}

void Fields::boolean(const char* name, bool& field, const char* sentence) {
  if (described_)
    describe({name, Parameter::Type::boolean, field, {}, {}, {}, "", sentence});
  else if (const auto* value = find(name))
    field = value->get<bool>();
}

void Fields::length(const char* name, Length& field, Bounds bounds, const char* sentence) {
  if (described_)
    describe({name, Parameter::Type::length, field.json(), bounds.minimum, bounds.maximum, {}, "CRS units", sentence});
  else if (const auto* value = find(name))
    field = Length::of(*value);
}

void Fields::length(const char* name, std::optional<Length>& field, Bounds bounds, const char* sentence) {
  Length value = field.value_or(Length{});
  const bool given = !described_ && find(name);
  length(name, value, bounds, sentence);
  if (described_ && !field) described_->back().default_value = nullptr;
  if (given) field = value;
}

void Fields::text(const char* name, std::string& field, const char* sentence) {
  if (described_)
    describe({name,
              Parameter::Type::text,
              field.empty() ? nlohmann::json() : nlohmann::json(field),
              {},
              {},
              {},
              "",
              sentence});
  else if (const auto* value = find(name))
    field = value->get<std::string>();
}

void Fields::crs(const char* name, std::string& field, const char* sentence) {
  if (described_)
    describe({name, Parameter::Type::crs, nullptr, {}, {}, {}, "", sentence});
  else if (const auto* value = find(name))
    field = value->get<std::string>();
}

void Fields::numbers(const char* name, std::vector<double>& field, const char* sentence) {
  if (described_)
    describe({name, Parameter::Type::numbers, field.empty() ? nlohmann::json() : nlohmann::json(field), {}, {}, {}, "",
              sentence});
  else if (const auto* value = find(name))
    field = value->get<std::vector<double>>();
}

void Fields::vectors(const char* name, std::optional<Vectors>& field, const char* sentence) {
  if (described_) return describe({name, Parameter::Type::vectors, nullptr, {}, {}, {}, "", sentence});
  if (!find(name)) return;
  field.emplace();
  if (vectors_) field = vectors_->at(name);
}

void Fields::points(const char* name, std::optional<Vectors>& field, const char* sentence) {
  vectors(name, field, sentence);
  if (described_) described_->back().corners_alone = true;
}

void Fields::json(const char* name, nlohmann::json& field, const nlohmann::json& schema, const char* sentence) {
  if (described_)
    describe({name, Parameter::Type::json, nullptr, {}, {}, {}, "", sentence, schema});
  else if (const auto* value = find(name))
    field = *value;
}

void CommonParameters::visit(Fields& f) {
  f.length("max-error", max_error, {.minimum = 0},
           "How far (vertically) the TIN made of a raster may lie from any of its samples, in the result's CRS; "
           "0 makes every sample a vertex.");
  f.crs(
      "assume-crs", assume_crs,
      "The CRS of inputs that have none: EPSG:25831, WKT, PROJJSON, local:m, local:ft or local:ftUS; INPUT:CRS for one "
      "input, several separated by semicolons.");
  f.crs("crs", crs, "The CRS of the inputs whatever they say themselves; written like assume-crs.");
  f.crs("target-crs", target_crs, "The CRS of the result, to which inputs in others are transformed.");
  f.length("grid", grid, {.minimum = 0},
           "Rounds x and y of a resulting surface to multiples of this length, verified: no face turns over, heights "
           "travel with their vertices, vertices that meet become one. In degrees the largest of 1, 2 or 5 x 10^-n "
           "within it. 0 leaves coordinates as they are.");
  f.text("format", format, "The format of the output where its name does not tell.");
  f.integer("threads", threads, {.minimum = 0, .maximum = 1024},
            "How many threads to use; 0 leaves it to the program. The result does not depend on it.");
  f.boolean("provenance", provenance,
            "Say for every face of a resulting surface which face of each input it lies on, counted from 0 as in the "
            "input's file (of a raster: as in the TIN that triangulate makes of it), null where there is none and for "
            "walls; and which input's height was decided for, null for several together. In Terrane JSON alone, as its "
            "member provenance: inputs, policy, faces, decided.");
}

}  // namespace terrane
