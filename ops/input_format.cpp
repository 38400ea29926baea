// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/input_format.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "core/error.hpp"
#include "ops/parameters.hpp"

namespace terrane {
namespace {

// What programs say when they do not know; such a type decides nothing.
constexpr std::array<std::string_view, 9> generic_types = {
    "application/octet-stream", "binary/octet-stream",
    "application/binary",       "text/plain",
    "application/xml",          "text/xml",
    "application/zip",          "application/x-www-form-urlencoded",
    "application/json"};

std::string bare_type(std::string_view media_type) {
  std::string type(media_type.substr(0, media_type.find(';')));
  while (!type.empty() && type.back() == ' ') type.pop_back();
  std::transform(type.begin(), type.end(), type.begin(), [](unsigned char c) { return std::tolower(c); });
  return type;
}

std::string readable_formats() {
  std::string list;
  for (const Format& format : formats())
    if (format.read) list += (list.empty() ? "" : ", ") + format.name + " (" + format.extensions.front() + ")";
  return list;
}

}  // namespace

std::string label(const InputPart& part) { return part.name.empty() ? part.slot : part.name; }

std::optional<Length> level_of(const InputPart& part, const InputSlot& slot) {
  if (!slot.takes_number || part.bytes.empty() || part.bytes.size() > 64) return {};
  char* end = nullptr;
  const double value = std::strtod(part.bytes.c_str(), &end);
  if (*end == 0 && !std::isfinite(value))
    throw Error(ErrorKind::input, "not-finite", "the level '" + part.bytes + "' is no finite number");
  return Length::read(part.bytes);
}

bool is_word(const InputPart& part, const InputSlot& slot) { return !slot.word.empty() && part.bytes == slot.word; }

const Format& input_format(const InputPart& part) {
  const std::string type = bare_type(part.media_type);
  const bool generic =
      type.empty() || std::find(generic_types.begin(), generic_types.end(), type) != generic_types.end();
  const Format* format = generic ? nullptr : format_of_media_type(type);
  if (!format && !generic)
    throw Error(ErrorKind::unsupported, "unsupported-format",
                "input '" + label(part) + "' is declared as " + type + ", which is not read here; readable are " +
                    readable_formats());
  if (!format && !part.name.empty()) format = format_of_file(part.name);
  const std::string_view head = std::string_view(part.bytes).substr(0, 4096);
  if (!format || !format->read)
    if (const Format* found = format_of_bytes(head)) format = found;
  if (!format && generic && !type.empty()) format = format_of_media_type(type);
  if (!format)
    throw Error(ErrorKind::unsupported, "unsupported-format",
                "input '" + label(part) +
                    "' is in no format that can be told from its media type, name or first bytes; "
                    "readable are " +
                    readable_formats());
  if (!format->read)
    throw Error(ErrorKind::unsupported, "unsupported-format",
                "input '" + label(part) + "' is " + format->name +
                    ", which can be written but not read; readable are " + readable_formats());
  return *format;
}

}  // namespace terrane
