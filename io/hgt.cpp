// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "io/bad_input.hpp"
#include "io/format_list.hpp"
#include "io/text.hpp"

// SRTM's HGT: nothing but big-endian 16-bit heights. The name says where:
// N44W072.hgt begins there and goes north and east.
namespace terrane {

namespace {

constexpr std::int16_t no_data = -32768;

struct Corner {
  int latitude, longitude;
};

Corner corner_of(const ReadOptions& options) {
  const std::string name = lower(options.name.substr(options.name.find_last_of("/\\") + 1));
  const auto number = [&](std::size_t first, std::size_t count) {
    int value = 0;
    for (std::size_t k = first; k < first + count; ++k) {
      if (k >= name.size() || name[k] < '0' || name[k] > '9') return -1;
      value = 10 * value + (name[k] - '0');
    }
    return value;
  };
  const int latitude = number(1, 2), longitude = number(4, 3);
  const bool good = name.size() >= 7 && (name[0] == 'n' || name[0] == 's') && (name[3] == 'e' || name[3] == 'w') &&
                    latitude >= 0 && latitude <= 90 && longitude >= 0 && longitude <= 180;
  if (!good)
    bad_input(options, "no-place", "",
              "an HGT file says where it lies only by its name; send it under its own, such as N44W072.hgt");
  return {name[0] == 's' ? -latitude : latitude, name[3] == 'w' ? -longitude : longitude};
}

Dataset read_hgt(Source source, const ReadOptions& options, Context& context) {
  const std::string_view bytes = source.rest();
  const Corner corner = corner_of(options);
  struct Size {
    int width, height;
  };
  constexpr Size sizes[] = {{1201, 1201}, {3601, 3601}, {1801, 3601}, {601, 1201}, {7201, 7201}};
  Raster raster;
  for (const Size& size : sizes)
    if (bytes.size() == 2 * static_cast<std::size_t>(size.width) * size.height) {
      raster.width = size.width;
      raster.height = size.height;
    }
  if (raster.width == 0)
    bad_input(options, "truncated", "",
              "an HGT tile has 1201 x 1201 or 3601 x 3601 samples of two bytes, but this file has " +
                  std::to_string(bytes.size()) + " bytes; send it again");
  check_count(options, bytes.size() / 2, options.max_samples, "samples");
  context.progress("read", 0);
  raster.x0 = corner.longitude;
  raster.y0 = corner.latitude + 1;
  raster.dx = 1.0 / (raster.width - 1);
  raster.dy = 1.0 / (raster.height - 1);
  raster.samples.resize(bytes.size() / 2);
  for (std::size_t k = 0; k < raster.samples.size(); ++k) {
    const auto high = static_cast<unsigned char>(bytes[2 * k]), low = static_cast<unsigned char>(bytes[2 * k + 1]);
    const auto height = static_cast<std::int16_t>(high << 8 | low);
    raster.samples[k] = height == no_data ? std::numeric_limits<double>::quiet_NaN() : height;
  }
  return {std::move(raster), Crs::parse("EPSG:4326")};
}

}  // namespace

Format hgt_format() {
  return {"hgt",
          {".hgt"},
          "application/x-srtm-hgt",
          "SRTM tile of one degree; its name says where it lies (N44W072.hgt).",
          read_hgt,
          nullptr,
          [](std::string_view) { return false; }};
}

}  // namespace terrane
