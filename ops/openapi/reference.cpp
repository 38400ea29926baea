// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "ops/memory.hpp"
#include "ops/openapi/describe.hpp"

// docs/reference.md, made from the catalogue.
namespace terrane {
namespace {

std::string type_word(const Parameter& p) {
  std::string text;
  switch (p.type) {
    case Parameter::Type::number:
      text = "number";
      break;
    case Parameter::Type::integer:
      text = "whole number";
      break;
    case Parameter::Type::boolean:
      text = "true or false";
      break;
    case Parameter::Type::text:
      text = "text";
      break;
    case Parameter::Type::crs:
      text = "CRS";
      break;
    case Parameter::Type::length:
      text = "length";
      break;
    case Parameter::Type::numbers:
      text = "numbers, or from:to:step";
      break;
    case Parameter::Type::vectors:
      text = "vectors";
      break;
    case Parameter::Type::json:
      text = "JSON";
      break;
    case Parameter::Type::choice:
      for (const std::string& word : p.choices) text += (text.empty() ? "" : ", ") + ("`" + word + "`");
  }
  const auto number = [](double v) {
    return v == static_cast<long>(v) ? std::to_string(static_cast<long>(v)) : nlohmann::json(v).dump();
  };
  if (p.minimum) text.append(", from ").append(number(*p.minimum));
  if (p.maximum) text.append(" up to ").append(number(*p.maximum));
  return text;
}

std::string default_word(const Parameter& p) {
  if (p.default_value.is_null()) return "–";
  std::string text = "`";
  return text.append(p.default_value.is_string() ? p.default_value.get<std::string>() : p.default_value.dump())
      .append("`");
}

std::string parameter_table(const std::vector<Parameter>& parameters) {
  std::string text = "| parameter | takes | default | |\n|---|---|---|---|\n";
  for (const Parameter& p : parameters)
    text += "| `" + p.name + "` | " + type_word(p) + " | " + default_word(p) + " | " + p.sentence + " |\n";
  return text + "\n";
}

std::string times(const InputSlot& slot) {
  if (slot.max_occurs == 0) return "one or more";
  return slot.min_occurs == 0 ? "may be left out" : "once";
}

std::string usage(const Operation& operation) {
  std::string text = "terrane " + operation.id;
  for (const InputSlot& slot : operation.inputs) {
    std::string word = slot.name;
    for (char& c : word) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    text += slot.min_occurs == 0 ? " [" + word + "]" : " " + word;
    if (slot.max_occurs == 0) text += " …";
  }
  return text + " [--parameter VALUE]… -o OUTPUT";
}

/// A text as one word of the shell.
std::string quoted(const std::string& text) {
  const bool plain = text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789=@.,:/-_") ==
                     std::string::npos;
  return plain ? text : "'" + text + "'";
}

/// The files of an example, by the input they are for.
std::vector<std::pair<std::string, std::string>> example_files(const Operation& operation) {
  std::vector<std::pair<std::string, std::string>> files;
  if (!operation.example.files.empty()) {
    for (std::size_t i = 0; i < operation.example.files.size(); ++i)
      files.emplace_back(operation.inputs[std::min(i, operation.inputs.size() - 1)].name, operation.example.files[i]);
    return files;
  }
  const auto add = [&](const InputSlot& slot) {
    files.emplace_back(slot.name, files.empty() ? "west.tif" : "east.tif");
  };
  for (const InputSlot& slot : operation.inputs)
    if (slot.min_occurs > 0) add(slot);
  if (files.size() == 1 && operation.inputs.front().max_occurs == 0) add(operation.inputs.front());
  return files;
}

/// Of the formats the one that most programs read.
std::string example_format(const Operation& operation) {
  const auto& words = operation.output_formats;
  return std::find(words.begin(), words.end(), "obj") != words.end() ? "obj" : words.front();
}

std::string example(const Operation& operation) {
  return "```sh test\n" + example_command(operation, "http://localhost:8080") + "\n```\n\n";
}

std::string memory(const Operation& operation) {
  const auto range = [](const MemoryUse& each) {
    return std::to_string(each.least) + " to " + std::to_string(each.most) + " bytes for each ";
  };
  const auto [face, cell] = memory_figures(operation.id);
  if (face.most == 0) return "";
  std::string text =
      "[Memory](memory.md): " + range(face) + "face of its " + (operation.inputs.empty() ? "result" : "inputs");
  if (cell.most > 0) text += ", and " + range(cell) + "cell of its result";
  return text + ".\n\n";
}

std::string section(const Operation& operation) {
  std::string text = "## " + operation.id + "\n\n" + operation.title + ". " + operation.description + "\n\n```\n" +
                     usage(operation) + "\n```\n\n| input | | |\n|---|---|---|\n";
  for (const InputSlot& slot : operation.inputs)
    text += "| `" + slot.name + "` | " + times(slot) + " | " + slot.sentence + " |\n";
  text += "\n";
  if (!operation.parameters.empty()) text += parameter_table(operation.parameters);
  text += "Returns";
  for (std::size_t i = 0; i < operation.output_formats.size(); ++i)
    text += (i ? ", `" : " `") + operation.output_formats[i] + "`";
  return text + " (the first unless asked otherwise).\n\n" + memory(operation) + example(operation);
}

std::string format_table() {
  std::string text =
      "## Formats\n\n| format | file names | media type | read | written | |\n|---|---|---|---|---|---|\n";
  for (const Format& f : formats()) {
    std::string extensions;
    for (const std::string& e : f.extensions) extensions += (extensions.empty() ? "`" : ", `") + e + "`";
    text += "| `" + f.name + "` | " + extensions + " | " + f.media_type + " | " + (f.read ? "yes" : "–") + " | " +
            (f.write ? "yes" : "–") + " | " + f.description + " |\n";
  }
  return text;
}

const char* const notes =
    R"(A raster is accepted wherever a TIN is: it is triangulated within `max-error`, and its cell centres are its
  domain. Lengths are
in the units of the CRS, or carry one of the units `m`, `ft`, `ftUS`. On the command line a parameter is `--name
VALUE` or
`--name=VALUE`; over HTTP it is a query parameter, a form field, or stands among the `inputs` of a JSON execute request.

Vectors (regions, lines, points) are a file that the command line names or that HTTP sends as a part: GeoJSON, WKT, a
GeoPackage, a zipped Shapefile, DXF, a table; or they are written out, as WKT or as coordinates `x,y;x,y`. GeoJSON is
longitude and latitude unless it carries a `crs` member; of other files the CRS they declare counts, and of what declares
none that of the result, unless a parameter such as `region-crs` says it. Their corners are transformed; the lines
between them are straight in the CRS of the result. All layers of a file are taken, and all shapefiles of a zip file, in
whatever folders. A table has a first line of names, `x` and `y` among them (or `easting`, `northing`, or `lon`, `lat`,
which are then what they say), cells apart by semicolons, commas, tabs or blanks; a column `z` is a height, any other a
property of its points. Places without properties are the corners of one line, as written-out coordinates are.

The examples send files to a service that runs here (`terrane serve`): `west.tif` and `east.tif` are DEMs that overlap,
`a.obj` and `b.obj` surfaces that are level at 0 and 255 with walls between, as `threshold` makes them.

Choices that are made here where others are possible:

- A CRS that is given for one input is written INPUT:CRS, with the input's name or its file name; several are
  separated by `;`.
- `grid` makes every x and y of a resulting surface the double nearest to a multiple of the length, so that they print
  short. Heights stay with their vertices, input vertices move too; the part `grid` of the certificate says how far, and
  what area was lost. Gaps and slivers narrower than the grid close, vertices that meet become one. A grid that leaves
  nothing of the surface is refused. Other results (reports, pictures) are not rounded.
- Without a CRS in any input all are in one local frame in metres. Inputs with a CRS and inputs without never mix.
- Areas and volumes are in squared and cubed CRS units where plan and height have the same unit, in m² and m³ otherwise.
  In geographic CRSs they are those on the ellipsoid. `area_balance` in the certificate is about the mesh and stays in
  squared
  CRS units, degrees included.
- In geographic CRSs several tiles are laid beside each other by whole turns of 360° before anything else; one tile
  alone stays
  where it is.
- `volume` takes `levels` instead of a reference, a row each; the sides are then called above and below.
- The area of a level is where z is at the level or above. A surface that only reaches it, at a peak or along a ridge,
  has no such area there; faces that lie exactly at it belong to it and are reported. The results of `threshold`,
  `quantize` and the logical operations keep of the points only those that the borders of their level areas need.
- A logical operation divides faces steeper than 89.9° half-way between the two levels; in degrees, and where heights
  have another unit than lengths, the angle is that on the ground.
- Parts of a surface that meet in one point only, as tiles do that touch in a corner, may have a height each there: no
  wall fits into a point. Any other place with two heights needs a wall, or an edge along which the surface jumps.
- Faces and vertices that `validate` and warnings name are counted from 0, whatever the file counts from.
- `validate` with `repair` keeps the earlier faces where faces overlap, in an order taken from their connection.
- Numbers in coordinates that all lie within 360 by 90 in a projected CRS are suspected to be degrees: refused where
  other inputs
  of the same request are clearly not, a warning otherwise.

)";

}  // namespace

std::string example_command(const Operation& operation, const std::string& base) {
  std::string text = "curl -fsS";
  for (const auto& [slot, file] : example_files(operation)) text += " -F " + slot + "=@" + file;
  for (const auto& [name, value] : operation.example.parameters) text += " --form-string " + quoted(name + "=" + value);
  const std::string format = example_format(operation);
  return text + " '" + base + "/processes/" + operation.id + "/execution?f=" + format + "' -o " + operation.id + "." +
         format;
}

std::string reference_page() {
  std::string text =
      "<!-- Generated by `terrane docs reference`; a test fails when it is stale. -->\n# The operations\n\n" +
      std::string(notes);
  for (const Operation& operation : catalogue()) text += section(operation);
  text += "## Parameters of every operation\n\n" + parameter_table(common_parameters()) + format_table();
  return text;
}

}  // namespace terrane
