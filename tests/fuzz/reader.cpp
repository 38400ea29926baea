// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "core/error.hpp"
#include "io/format.hpp"

// libFuzzer on one reader (TERRANE_FUZZ_FORMAT). Any bytes end in a sound value or in an Error about the input; a mesh
// that was read comes back the same after writing.
namespace {

using namespace terrane;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", what);
  std::abort();
}

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

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Format& format = *format_named(TERRANE_FUZZ_FORMAT);
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  Context context;
  try {
    format_of_bytes(bytes);
    const Dataset dataset =
        format.read(bytes, {.name = "N44W072.hgt", .max_vertices = 1'000'000, .max_samples = 1'000'000}, context);
    if (const Tin* tin = std::get_if<Tin>(&dataset.surface))
      check_tin(*tin, dataset.crs, format);
    else
      check_raster(std::get<Raster>(dataset.surface));
  } catch (const Error& error) {
    require(error.kind == ErrorKind::input || error.kind == ErrorKind::limit, error.what());
  }
  return 0;
}
