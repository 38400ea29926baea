// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <set>

#include "core/error.hpp"
#include "io/text.hpp"
#include "ops/input_format.hpp"
#include "ops/operation.hpp"
#include "ops/parameters.hpp"
#include "ops/sha256.hpp"

// Every complaint that can be made before an input is decoded is made here.
namespace terrane {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list;
}

std::vector<Parameter> parameters_of(const Operation& operation) {
  std::vector<Parameter> all = operation.parameters;
  for (Parameter& p : common_parameters_of(operation)) all.push_back(std::move(p));
  return all;
}

/// Words that may stand before the colon in INPUT:CRS.
std::vector<std::string> input_names(const Request& request, const Operation& operation) {
  std::vector<std::string> names;
  for (const InputSlot& slot : operation.inputs) names.push_back(slot.name);
  for (const InputPart& part : request.inputs)
    if (!part.name.empty()) names.push_back(part.name);
  return names;
}

void check_crs(const std::string& name, const std::string& text, const Request& request, const Operation& operation) {
  const bool per_input = name == "crs" || name == "assume-crs";
  const auto rules =
      per_input ? parse_crs_rules(text, input_names(request, operation)) : std::vector<CrsRule>{{"", text}};
  for (const CrsRule& rule : rules) try {
      Crs::parse(rule.crs);
    } catch (const Error& error) {
      throw Error(ErrorKind::usage, error.code, "parameter '" + name + "': " + error.what());
    }
}

/// What a certificate says of vectors: themselves when they are short, else what they can be known again by.
nlohmann::json shown(const std::string& vectors) {
  const bool text = std::all_of(vectors.begin(), vectors.end(), [](char c) { return c >= ' ' && c <= '~'; });
  if (text && vectors.size() <= 200) return vectors;
  return {{"bytes", vectors.size()}, {"sha256", sha256(vectors)}};
}

nlohmann::json parse_parameters(Request& request, const Operation& operation, Plan& made) {
  const auto all = parameters_of(operation);
  nlohmann::json values = nlohmann::json::object();
  for (const Parameter& p : all)
    if (!p.default_value.is_null()) values[p.name] = p.default_value;

  std::set<std::string> seen;
  for (auto& [name, text] : request.parameters) {
    const auto it =
        std::find_if(all.begin(), all.end(), [&name = name](const Parameter& p) { return p.name == name; });
    if (it == all.end()) {
      std::vector<std::string> names;
      for (const Parameter& p : all) names.push_back(p.name);
      throw Error(ErrorKind::usage, "unknown-parameter",
                  "'" + operation.id + "' has no parameter '" + name.substr(0, 80) + "'; it has " + joined(names));
    }
    if (!seen.insert(name).second)
      throw Error(ErrorKind::usage, "repeated-parameter", "parameter '" + name + "' is given more than once");
    values[name] = parse_parameter(*it, text);
    if (it->type == Parameter::Type::vectors) {
      values[name] = shown(text);
      made.vectors[name] = std::move(text);
    }
    if (it->type == Parameter::Type::crs) check_crs(name, values[name], request, operation);
  }
  for (const Parameter& p : all)
    if (p.type == Parameter::Type::vectors && !seen.contains(p.name) && seen.contains(p.name + "-crs"))
      throw Error(ErrorKind::usage, "surplus-parameter",
                  "parameter '" + p.name + "-crs' says where '" + p.name + "' is, which is not given");
  if (const auto it = values.find("format"); it != values.end()) {
    if (request.format.empty()) request.format = *it;
    values.erase(it);
  }
  return values;
}

void check_inputs(const Request& request, const Operation& operation) {
  std::vector<std::string> names;
  for (const InputSlot& slot : operation.inputs) names.push_back(slot.name);
  for (const InputPart& part : request.inputs)
    if (std::find(names.begin(), names.end(), part.slot) == names.end())
      throw Error(
          ErrorKind::usage, "unknown-input",
          "'" + operation.id + "' has no input '" + part.slot.substr(0, 80) + "'; its inputs are " + joined(names));
  for (const InputSlot& slot : operation.inputs) {
    const auto count = std::count_if(request.inputs.begin(), request.inputs.end(),
                                     [&](const InputPart& part) { return part.slot == slot.name; });
    if (count < slot.min_occurs)
      throw Error(ErrorKind::usage, "missing-input",
                  "'" + operation.id + "' needs the input '" + slot.name + "': " + slot.sentence);
    if (slot.max_occurs > 0 && count > slot.max_occurs)
      throw Error(ErrorKind::usage, "surplus-input",
                  "'" + operation.id + "' takes the input '" + slot.name + "' " +
                      (slot.max_occurs == 1 ? "once" : std::to_string(slot.max_occurs) + " times") + ", not " +
                      std::to_string(count) + " times");
  }
  if (operation.run_plain) return;
  for (const InputPart& part : request.inputs) {
    const auto slot = std::find_if(operation.inputs.begin(), operation.inputs.end(),
                                   [&](const InputSlot& s) { return s.name == part.slot; });
    if (!is_word(part, *slot) && !level_of(part, *slot)) input_format(part);
  }
}

/// Where an operation's result can be of two kinds, which parameter makes a format possible that is not now.
[[noreturn]] void refuse_format(const Operation& operation, const std::string& asked,
                                const std::vector<std::string>& possible) {
  const bool other = std::find(operation.output_formats.begin(), operation.output_formats.end(), asked) !=
                     operation.output_formats.end();
  throw Error(ErrorKind::usage, "unknown-format",
              "'" + operation.id + "' cannot return '" + asked.substr(0, 80) + "'" +
                  (other ? " with these parameters" : "") + "; formats are " + joined(possible));
}

bool accepts(std::string type, const std::string& media_type) {
  type = type.substr(0, type.find(';'));
  type.erase(std::remove(type.begin(), type.end(), ' '), type.end());
  std::transform(type.begin(), type.end(), type.begin(), [](unsigned char c) { return std::tolower(c); });
  if (type == "*/*" || type == "*") return true;
  if (type.ends_with("/*")) return media_type.starts_with(type.substr(0, type.size() - 1));
  return type == media_type.substr(0, media_type.find(';'));
}

/// Reports and pictures come in formats that are no formats of TINs, so file names are told apart here.
std::string format_by_name(const std::string& file, ResultKind kind, const std::vector<std::string>& possible) {
  if (lower(file).ends_with(".city.json")) return "city.json";  // which is not made, and no other JSON
  if (kind != ResultKind::surface) {
    const std::size_t dot = file.rfind('.');
    return dot == std::string::npos ? "" : file.substr(dot + 1);
  }
  const Format* format = format_of_file(file);
  if (format && std::find(possible.begin(), possible.end(), format->name) == possible.end()) {
    // Several words may share an extension; the first of them that can be written is meant.
    for (const std::string& word : possible)
      for (const std::string& extension : format_named(word)->extensions)
        if (file.ends_with(extension)) return word;
  }
  if (format) return format->name;
  const std::size_t dot = file.rfind('.');
  return dot == std::string::npos ? "" : file.substr(dot + 1);
}

std::string choose_format(const Request& request, const Operation& operation, ResultKind kind) {
  const auto possible = operation.result_with ? formats_of(kind) : operation.output_formats;
  const auto check = [&](const std::string& word) {
    if (std::find(possible.begin(), possible.end(), word) == possible.end()) refuse_format(operation, word, possible);
    return word;
  };
  if (!request.format.empty()) return check(request.format);
  if (!request.output_name.empty()) {
    const std::string word = format_by_name(request.output_name, kind, possible);
    if (!word.empty()) return check(word);
  }
  if (request.accept.empty()) return possible.front();
  for (const std::string& type : request.accept)
    for (const std::string& word : possible)
      if (accepts(type, media_type_of(word))) return word;
  std::vector<std::string> types;
  for (const std::string& word : possible) types.push_back(media_type_of(word) + " (" + word + ")");
  throw Error(ErrorKind::not_acceptable, "not-acceptable",
              "'" + operation.id + "' returns none of the media types that are accepted; it returns " + joined(types));
}

/// The provenance of faces has a place in Terrane JSON alone.
void check_provenance(const Plan& made) {
  if (!made.parameters.value("provenance", false)) return;
  const std::string& id = made.operation->id;
  if (made.operation->kind(made.parameters) != ResultKind::surface)
    throw Error(ErrorKind::usage, "provenance",
                "parameter 'provenance': with these parameters '" + id + "' returns no surface, whose faces have any");
  if (made.output_format != "json")
    throw Error(ErrorKind::usage, "provenance",
                "parameter 'provenance': only Terrane JSON can hold it, not '" + made.output_format +
                    "'; ask for the format json");
  if (made.request.inputs.size() > 10000)
    throw Error(ErrorKind::usage, "provenance", "parameter 'provenance' is for up to 10000 inputs");
}

}  // namespace

Plan plan(Request request) {
  Plan made;
  made.operation = &find_operation(request.operation);
  made.parameters = parse_parameters(request, *made.operation, made);
  made.output_format = choose_format(request, *made.operation, made.operation->kind(made.parameters));
  check_inputs(request, *made.operation);
  if (made.operation->check) made.operation->check(made.parameters, request.inputs);
  made.request = std::move(request);
  check_provenance(made);
  return made;
}

}  // namespace terrane
