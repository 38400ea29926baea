// SPDX-License-Identifier: GPL-3.0-or-later
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.hpp"
#include "io/format.hpp"
#include "io/gdal.hpp"
#include "io/geodesy_osr.hpp"
#include "io/text.hpp"

// Rasters as files: GeoTIFF through GDAL, Esri's ASCII grid by hand, for GDAL rounds its numbers.
namespace terrane {

namespace {

constexpr double no_data = -9999;
constexpr int block = 256;

[[noreturn]] void failed() { throw Error(ErrorKind::internal, "tif", "the raster could not be written as GeoTIFF"); }

/// A height that happens to be the NoData value goes to the double beside it: it is no void.
double stored(double z) { return std::isnan(z) ? no_data : z == no_data ? std::nextafter(z, 0.0) : z; }

void write_rows(GDALRasterBand& band, const Raster& raster, Context& context) {
  std::vector<double> rows(static_cast<std::size_t>(raster.width) * std::min(block, raster.height));
  for (int first = 0; first < raster.height; first += block) {
    context.progress("write", static_cast<double>(first) / raster.height);
    const int count = std::min(block, raster.height - first);
    const double* from = raster.samples.data() + static_cast<std::size_t>(first) * raster.width;
    std::transform(from, from + static_cast<std::size_t>(count) * raster.width, rows.begin(), stored);
    if (band.RasterIO(GF_Write, 0, first, raster.width, count, rows.data(), raster.width, count, GDT_Float64, 0, 0,
                      nullptr) != CE_None)
      failed();
  }
}

/// False where keys of the file do not say what the CRS is.
bool holds(const OGRSpatialReference* written, const OGRSpatialReference& meant) {
  if (!written) return false;
  const char* options[] = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES", nullptr};
  return written->IsSame(&meant, options);
}

std::string geotiff(const Raster& raster, const Crs& crs, Context& context) {
  const ClosedGdal closed;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  if (!driver) failed();
  const bool blocks = raster.width > block || raster.height > block;
  std::vector<const char*> options = {"COMPRESS=DEFLATE", "PREDICTOR=3", "BIGTIFF=IF_SAFER", "NUM_THREADS=1",
                                      "GEOTIFF_VERSION=1.1"};
  if (blocks) options.insert(options.end(), {"TILED=YES", "BLOCKXSIZE=256", "BLOCKYSIZE=256"});
  options.push_back(nullptr);
  const MemoryFile file(".tif");
  {
    const DatasetHandle out(driver->Create(file.name().c_str(), raster.width, raster.height, 1, GDT_Float64,
                                           const_cast<char**>(options.data())));
    if (!out) failed();
    double place[6] = {raster.x0 - raster.dx / 2, raster.dx, 0, raster.y0 + raster.dy / 2, 0, -raster.dy};
    if (out->SetGeoTransform(place) != CE_None) failed();
    if (crs.known() && !crs.local()) {
      const OGRSpatialReference meant = osr(crs.inside().definition);
      if (out->SetSpatialRef(&meant) != CE_None) failed();
    }
    if (out->GetRasterBand(1)->SetNoDataValue(no_data) != CE_None) failed();
    write_rows(*out->GetRasterBand(1), raster, context);
  }
  if (crs.local())
    context.warn({"crs-not-held", "", "", "a GeoTIFF cannot say that it is in the local frame " + crs.name(),
                  "give it again with assume-crs where the file is read"});
  if (crs.known() && !crs.local()) {
    const DatasetHandle in(static_cast<GDALDataset*>(
        GDALOpenEx(file.name().c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, nullptr, nullptr, nullptr)));
    if (!in || !holds(in->GetSpatialRef(), osr(crs.inside().definition)))
      context.warn({"crs-not-held", "", "",
                    "the GeoTIFF cannot hold all of the coordinate reference system " + crs.name(),
                    "give it again with crs where the file is read, or choose a target-crs with an EPSG code"});
  }
  std::string bytes = file.contents();
  if (bytes.empty()) failed();
  return bytes;
}

void put_line(std::string& text, const char* key, double value) {
  char number[number_size];
  text += key;
  text.append(number, put_number(number, value));
  text += '\n';
}

std::string ascii_grid(const Raster& raster, Context& context) {
  std::string text = "ncols " + std::to_string(raster.width) + "\nnrows " + std::to_string(raster.height) + "\n";
  put_line(text, "xllcenter ", raster.x0);
  put_line(text, "yllcenter ", raster.y0 - (raster.height - 1) * raster.dy);
  if (raster.dx == raster.dy) {
    put_line(text, "cellsize ", raster.dx);
  } else {
    put_line(text, "dx ", raster.dx);
    put_line(text, "dy ", raster.dy);
  }
  put_line(text, "NODATA_value ", no_data);
  char number[number_size];
  for (int j = 0; j < raster.height; ++j) {
    context.progress("write", static_cast<double>(j) / raster.height);
    for (int i = 0; i < raster.width; ++i) {
      if (i > 0) text += ' ';
      text.append(number, put_number(number, stored(raster.at(i, j))));
    }
    text += '\n';
  }
  return text;
}

}  // namespace

std::string write_raster(const Raster& raster, const Crs& crs, std::string_view word, Context& context) {
  if (raster.width < 1 || raster.height < 1)
    throw Error(ErrorKind::internal, "raster", "a raster without samples cannot be written");
  if (word == "asc") return ascii_grid(raster, context);
  if (word == "tif") return geotiff(raster, crs, context);
  throw Error(ErrorKind::internal, "raster", "no raster is written as '" + std::string(word) + "'");
}

}  // namespace terrane
