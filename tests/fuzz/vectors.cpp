// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vectors.hpp"

#include <cmath>
#include <cstdint>
#include <string_view>

#include "core/error.hpp"
#include "fuzz/require.hpp"

// libFuzzer on vector files: any bytes end in sound shapes or in an Error about the input, and what GeoJSON was made of
// the shapes comes back as it was.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace terrane;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  Context context;
  Vectors vectors;
  try {
    vectors = read_vectors(bytes, "input", context);
  } catch (const Error& error) {
    fuzz::require(error.kind == ErrorKind::input || error.kind == ErrorKind::limit, error.what());
    return 0;
  }
  for (const Point& p : vectors.points())
    fuzz::require(std::isfinite(p.x) && std::isfinite(p.y) && !std::isinf(p.z), "finite coordinates");
  for (const Polygon& polygon : vectors.polygons()) fuzz::require(polygon.outer.size() >= 3, "rings have corners");
  vectors.crs = {};
  const std::string written = write_vectors(vectors, "geojson");
  const Vectors again = read_vectors(written, "again", context);
  fuzz::require(write_vectors(again, "geojson") == written, "the same after a round trip");
  return 0;
}
