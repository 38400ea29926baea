// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/help.hpp"

#include <cctype>

#include "server/settings.hpp"

namespace terrane {
namespace {

constexpr std::size_t width = 100;

std::string padded(std::string text, std::size_t columns) {
  text.resize(std::max(columns, text.size() + 2), ' ');
  return text;
}

/// A word and its explanation, wrapped beside it.
std::string entry(const std::string& word, const std::string& sentence, std::size_t column) {
  std::string out = padded("  " + word, column), line;
  const std::string pad(column, ' ');
  if (out.size() > column) out += "\n" + pad;
  std::size_t begin = 0;
  while (begin < sentence.size()) {
    const std::size_t end = std::min(sentence.find(' ', begin), sentence.size());
    const std::string next = sentence.substr(begin, end - begin);
    if (!line.empty() && column + line.size() + 1 + next.size() > width) {
      out += line + "\n" + pad;
      line.clear();
    }
    line += (line.empty() ? "" : " ") + next;
    begin = end + 1;
  }
  return out + line + "\n";
}

std::string upper(std::string word) {
  for (char& c : word) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return word;
}

std::string placeholder(const Parameter& p) {
  switch (p.type) {
    case Parameter::Type::number: return " NUMBER";
    case Parameter::Type::integer: return " N";
    case Parameter::Type::boolean: return "";
    case Parameter::Type::text: return " TEXT";
    case Parameter::Type::crs: return " CRS";
    case Parameter::Type::length: return " LENGTH";
    case Parameter::Type::numbers: return " NUMBERS";
    case Parameter::Type::vectors: return " FILE|TEXT";
    case Parameter::Type::json: return " JSON";
    case Parameter::Type::choice: break;
  }
  std::string words;
  for (const std::string& word : p.choices) words += (words.empty() ? " " : "|") + word;
  return words;
}

std::string parameter_entries(const std::vector<Parameter>& parameters) {
  std::string text;
  for (const Parameter& p : parameters) {
    if (p.name == "format") continue;  // among the flags
    std::string sentence = p.sentence;
    if (!p.default_value.is_null() && p.type != Parameter::Type::boolean)
      sentence +=
          " [" + (p.default_value.is_string() ? p.default_value.get<std::string>() : p.default_value.dump()) + "]";
    text += entry("--" + p.name + placeholder(p), sentence, 30);
  }
  return text;
}

}  // namespace

std::string general_help() {
  std::string text = "terrane " TERRANE_VERSION
                     ": exact algebra on terrain surfaces\n\n"
                     "  terrane OPERATION INPUT... [--parameter VALUE]... -o OUTPUT\n"
                     "  terrane serve [--port N] [--setting VALUE]...\n"
                     "  terrane docs openapi|openapi-3.0|reference|settings\n\nOperations (terrane OPERATION --help says more):\n";
  for (const Operation& operation : catalogue()) text += entry(operation.id, operation.title, 16);
  text += "\nFormats:\n";
  for (const Format& format : formats())
    text +=
        entry(format.name,
              format.description + (format.read ? format.write ? " (read, written)" : " (read)" : " (written)"), 16);
  return text + "\nExit codes: 0 done, 2 usage or parameter, 3 input data, 4 limit, 5 our fault.\n";
}

std::string operation_help(const Operation& operation) {
  std::string text = "terrane " + operation.id;
  for (const InputSlot& slot : operation.inputs) {
    text += slot.min_occurs == 0 ? " [" : " ";
    text += upper(slot.name);
    if (slot.min_occurs == 0) text += "]";
    if (slot.max_occurs == 0) text += "...";
  }
  const bool prints = operation.result == ResultKind::report || operation.result == ResultKind::table;
  text += prints ? " [--parameter VALUE]... [-o OUTPUT]\n\n" : " [--parameter VALUE]... -o OUTPUT\n\n";
  text += operation.description + "\n\nInputs (- reads standard input):\n";
  for (const InputSlot& slot : operation.inputs) text += entry(upper(slot.name), slot.sentence, 16);
  if (!operation.parameters.empty()) text += "\nParameters:\n" + parameter_entries(operation.parameters);
  if (const auto common = common_parameters_of(operation); !common.empty())
    text += "\nParameters of every operation:\n" + parameter_entries(common);
  std::string words;
  for (const std::string& word : operation.output_formats) words += (words.empty() ? "" : ", ") + word;
  text += "\nFlags:\n" +
          entry("-o, --output FILE",
                prints ? "Where the result goes; standard output otherwise."
                       : "Where the result goes; - is standard output.",
                30) +
          entry("--report FILE", "Where the certificate goes, as JSON.", 30) +
          entry("--format F", "One of " + words + "; otherwise the output's name decides.", 30) +
          entry("--force", "Replace an output that exists.", 30) +
          entry("--quiet", "Neither progress nor warnings.", 30);
  return text;
}

std::string serve_help() {
  std::string text =
      "terrane serve [--setting VALUE]...\n\n"
      "The operations over HTTP (OGC API - Processes). Every setting can also be an environment variable\n"
      "(--max-body: TERRANE_MAX_BODY) or a member of the JSON file that --config names (\"max-body\"). A flag\n"
      "wins over the environment, that over the file. Sizes carry K, M, G or T.\n\n";
  for (const Setting& setting : settings()) {
    const std::string value = setting.is_flag() ? "" : default_text(setting);
    const std::string placeholder(setting.placeholder);
    text += entry("--" + std::string(setting.name) + (placeholder.empty() ? "" : " ") + placeholder,
                  std::string(setting.sentence) + (value.empty() ? "" : " [" + value + "]"), 24);
  }
  return text;
}

}  // namespace terrane
