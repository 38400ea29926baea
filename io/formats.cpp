// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/format_list.hpp"
#include "io/text.hpp"

namespace terrane {

const std::vector<Format>& formats() {
  static const std::vector<Format> list = {obj_format(),     json_format(), ply_format(),
                                           geotiff_format(), hgt_format(),  ascii_grid_format(),
                                           las_format(),     point_table_format()};
  return list;
}

const Format* format_named(std::string_view word) {
  for (const Format& format : formats())
    if (format.name == word) return &format;
  return nullptr;
}

const Format* format_of_media_type(std::string_view media_type) {
  const std::string type = lower(trimmed(media_type.substr(0, media_type.find(';'))));
  for (const Format& format : formats())
    if (format.media_type == type) return &format;
  return nullptr;
}

const Format* format_of_file(std::string_view file_name) {
  const std::string name = lower(file_name);
  const Format* best = nullptr;
  std::size_t length = 0;
  for (const Format& format : formats())
    for (const std::string& extension : format.extensions)
      if (extension.size() > length && name.ends_with(extension)) {
        best = &format;
        length = extension.size();
      }
  return best;
}

const Format* format_of_bytes(std::string_view head) {
  for (const Format& format : formats())
    if (format.sniff && format.sniff(without_mark(head))) return &format;
  return nullptr;
}

std::string written(const Format& format, const Tin& tin, const Crs& crs, const WriteOptions& options,
                    Context& context) {
  std::string bytes;
  // What a TIN takes as text; growing from nothing would take twice that for a moment.
  bytes.reserve(256 + options.certificate_json.size() + tin.vertices.size() * 48 + tin.faces.size() * 22);
  format.write(tin, crs, options, [&](std::string_view piece) { bytes.append(piece); }, context);
  return bytes;
}

}  // namespace terrane
