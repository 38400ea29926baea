// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "io/format.hpp"
#include "io/gdal.hpp"
#include "io/geodesy_osr.hpp"
#include "io/text.hpp"

// Rasters as files: GeoTIFF through GDAL, ESRI's ASCII grid by hand, for GDAL rounds its numbers.
namespace terrane {
namespace {

constexpr double no_data = -9999;

[[noreturn]] void failed() { throw Error(ErrorKind::internal, "tif", "the raster could not be written as GeoTIFF"); }

std::string geotiff(const Raster& raster, const Crs& crs) {
  const ClosedGdal closed;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  if (!driver) failed();
  const char* options[] = {"COMPRESS=DEFLATE",    "PREDICTOR=3",   "TILED=YES", "BIGTIFF=IF_SAFER",
                           "GEOTIFF_VERSION=1.1", "NUM_THREADS=1", nullptr};
  const MemoryFile file(".tif");
  {
    const DatasetHandle dataset(
        driver->Create(file.name().c_str(), raster.width, raster.height, 1, GDT_Float64, const_cast<char**>(options)));
    if (!dataset) failed();
    double place[6] = {raster.x0 - raster.dx / 2, raster.dx, 0, raster.y0 + raster.dy / 2, 0, -raster.dy};
    dataset->SetGeoTransform(place);
    if (crs.known() && !crs.local()) {
      const OGRSpatialReference srs = osr(crs.inside().definition);
      dataset->SetSpatialRef(&srs);
    }
    GDALRasterBand* band = dataset->GetRasterBand(1);
    band->SetNoDataValue(no_data);
    std::vector<double> row(raster.width);
    for (int j = 0; j < raster.height; ++j) {
      for (int i = 0; i < raster.width; ++i) row[i] = std::isnan(raster.at(i, j)) ? no_data : raster.at(i, j);
      if (band->RasterIO(GF_Write, 0, j, raster.width, 1, row.data(), raster.width, 1, GDT_Float64, 0, 0, nullptr) !=
          CE_None)
        failed();
    }
  }
  std::string bytes = file.contents();
  if (bytes.empty()) failed();
  return bytes;
}

std::string ascii_grid(const Raster& raster) {
  std::string out;
  const auto header = [&](const char* key, double value) {
    char number[number_size];
    out.append(key).append(" ").append(number, put_number(number, value)).append("\n");
  };
  header("ncols", raster.width);
  header("nrows", raster.height);
  header("xllcenter", raster.x0);
  header("yllcenter", raster.y0 - (raster.height - 1) * raster.dy);
  if (raster.dx == raster.dy) {
    header("cellsize", raster.dx);
  } else {
    header("dx", raster.dx);
    header("dy", raster.dy);
  }
  header("NODATA_value", no_data);
  char number[number_size];
  for (int j = 0; j < raster.height; ++j) {
    for (int i = 0; i < raster.width; ++i) {
      const double z = std::isnan(raster.at(i, j)) ? no_data : raster.at(i, j);
      out.append(i > 0 ? " " : "").append(number, put_number(number, z));
    }
    out += '\n';
  }
  return out;
}

}  // namespace

std::string write_raster(const Raster& raster, const Crs& crs, std::string_view word) {
  return word == "asc" ? ascii_grid(raster) : geotiff(raster, crs);
}

}  // namespace terrane
