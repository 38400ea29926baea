// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/zipped_shapefile.hpp"

#include <cpl_string.h>
#include <cpl_vsi.h>

#include <algorithm>
#include <memory>

#include "core/error.hpp"
#include "io/geodesy.hpp"
#include "io/text.hpp"

namespace terrane {
namespace {

constexpr double max_unzipped = 1e9;
constexpr std::size_t max_entries = 1000;  // folders counted: GDAL looks through all of them for each

[[noreturn]] void damaged(const std::string& name) {
  throw Error(ErrorKind::input, "wrong-magic",
              name + ": the zip file cannot be read; it is damaged or cut off, send it again");
}

/// Before GDAL sees the file. What it believes are the numbers at the end of the zip file's directory.
void check_directory(std::string_view bytes, const std::string& name) {
  const std::string_view tail = bytes.substr(bytes.size() - std::min<std::size_t>(bytes.size(), 66'000));
  const std::size_t at = tail.rfind("PK\5\6"), left = at == std::string_view::npos ? 0 : tail.size() - at;
  const auto number = [&](std::size_t offset, int size) {
    std::size_t value = 0;
    for (int i = size; i-- > 0;) value = value << 8 | static_cast<unsigned char>(tail[at + offset + i]);
    return value;
  };
  if (left < 22 || number(12, 4) > bytes.size() - left) damaged(name);
  const std::string_view directory = bytes.substr(bytes.size() - left - number(12, 4), number(12, 4));
  const auto folders = std::count_if(directory.begin(), directory.end(), [](char c) { return c == '/' || c == '\\'; });
  const bool large = tail.find("PK\6\7") != std::string_view::npos;  // zip64: other numbers count
  if (large || number(10, 2) + static_cast<std::size_t>(folders) > max_entries)
    throw Error(ErrorKind::limit, "too-many-entries",
                name + ": the zip file has more than 1000 files and folders; send the one layer that counts");
}

std::string start_of(const std::string& file) {
  std::string text(100'000, '\0');
  VSILFILE* opened = VSIFOpenL(file.c_str(), "rb");
  if (!opened) return "";
  text.resize(VSIFReadL(text.data(), 1, text.size(), opened));
  VSIFCloseL(opened);
  return text;
}

/// macOS puts a file of its own attributes beside every other: "__MACOSX/parcels/._parcels.shp".
bool is_shapefile(std::string_view path) {
  return lower(path).ends_with(".shp") && !path.substr(path.rfind('/') + 1).starts_with("._");
}

}  // namespace

void refuse_grid_files(std::string_view definition, const std::string& name) {
  if (names_files(definition))
    throw Error(ErrorKind::input, "bad-crs",
                name + ": its coordinate reference system names grid files, which is not allowed");
}

std::vector<std::string> shapefiles_in(std::string_view bytes, const std::string& file, const std::string& name) {
  check_directory(bytes, name);
  const std::string folder = "/vsizip/{" + file + "}";
  const std::unique_ptr<char*, void (*)(char**)> entries(VSIReadDirRecursive(folder.c_str()), CSLDestroy);
  if (!entries) damaged(name);
  double size = 0;
  std::vector<std::string> found;
  for (char** entry = entries.get(); *entry; ++entry) {
    const std::string path = folder + "/" + *entry;
    VSIStatBufL facts;
    if (VSIStatL(path.c_str(), &facts) == 0) size += static_cast<double>(facts.st_size);
    if (is_shapefile(*entry)) found.push_back(path);
    if (lower(*entry).ends_with(".prj")) refuse_grid_files(start_of(path), name);
  }
  if (found.empty()) throw Error(ErrorKind::input, "no-shapefile", name + ": there is no .shp in the zip file");
  if (size > max_unzipped)
    throw Error(ErrorKind::limit, "too-large",
                name + ": it unpacks to more than 1 GB; send the one layer that counts");
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace terrane
