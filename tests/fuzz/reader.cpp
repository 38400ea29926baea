// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include "core/error.hpp"
#include "fuzz/require.hpp"
#include "io/format.hpp"

// libFuzzer on one reader (TERRANE_FUZZ_FORMAT). Any bytes end in a sound value or in an Error about the input; a mesh
// that was read comes back the same after writing.
namespace {

using namespace terrane;

using fuzz::require;

void check_tin(const Tin& tin, const Crs& crs, const Format& format) {
  for (const Point& p : tin.vertices)
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "finite coordinates");
  for (const Face& face : tin.faces)
    for (Index v : face) require(v >= 0 && static_cast<std::size_t>(v) < tin.vertices.size(), "indices in range");
  Context context;
  const std::string bytes = written(format, tin, crs, {}, context);
  const Dataset again = format.read(bytes, {.name = "again"}, context);
  require(std::get<Tin>(again.surface) == tin, "the same mesh after a round trip");
  require(again.crs.id() == crs.id(), "the same CRS after a round trip");
}

void check_raster(const Raster& raster) {
  require(raster.width > 0 && raster.height > 0 && raster.dx > 0 && raster.dy > 0, "a raster with cells");
  require(raster.samples.size() == static_cast<std::size_t>(raster.width) * raster.height, "all samples");
  require(std::isfinite(raster.x0) && std::isfinite(raster.y0), "a finite place");
  for (double z : raster.samples) require(!std::isinf(z), "no infinite height");
}

void check_points(const PointCloud& cloud) {
  require(!cloud.points.empty(), "some points");
  for (const Point& p : cloud.points)
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "finite coordinates");
}

/// What reading ends in: a value, or what an Error says.
struct Ending {
  Dataset dataset;
  std::string complaint;
};

Ending read(const Format& format, Source source) {
  Context context;
  try {
    return {format.read(std::move(source),
                        {.name = "N44W072.hgt", .max_vertices = 1'000'000, .max_samples = 1'000'000}, context),
            ""};
  } catch (const Error& error) {
    require(error.kind == ErrorKind::input || error.kind == ErrorKind::limit, error.what());
    return {{}, error.what()};
  }
}

/// Blocks may end anywhere, and every piece of them may be as short as a file's last.
void check_blocks(const Format& format, std::string_view bytes, const Ending& whole) {
  if (bytes.find('\0') != std::string_view::npos && format.name == "obj") return;  // refused where it is met
  const std::size_t block = 1 + bytes.size() % 61;
  std::size_t at = 0;
  const auto fill = [&](char* to, std::size_t size) {
    const std::size_t count = bytes.copy(to, std::min(size, 1 + at % 7), at);
    at += count;
    return count;
  };
  const Ending pieces = read(format, Source(fill, bytes.size(), block));
  if (pieces.complaint != whole.complaint) std::fprintf(stderr, "%s\n%s\n", whole.complaint.c_str(), pieces.complaint.c_str());
  require(pieces.complaint == whole.complaint, "the same complaint for any blocks");
  const Tin* tin = std::get_if<Tin>(&whole.dataset.surface);
  require(!tin || std::get<Tin>(pieces.dataset.surface) == *tin, "the same mesh for any blocks");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Format& format = *format_named(TERRANE_FUZZ_FORMAT);
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  format_of_bytes(bytes);
  const Ending whole = read(format, bytes);
  if (format.write) check_blocks(format, bytes, whole);
  if (!whole.complaint.empty()) return 0;
  if (const Tin* tin = std::get_if<Tin>(&whole.dataset.surface))
    check_tin(*tin, whole.dataset.crs, format);
  else if (const PointCloud* cloud = std::get_if<PointCloud>(&whole.dataset.surface))
    check_points(*cloud);
  else
    check_raster(std::get<Raster>(whole.dataset.surface));
  return 0;
}
