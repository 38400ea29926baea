// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include <cpl_conv.h>
#include <ogr_spatialref.h>

#include "core/shortest.hpp"
#include "io/bad_input.hpp"
#include "io/format_list.hpp"
#include "io/gdal.hpp"
#include "io/text.hpp"
#include "io/tiff_directory.hpp"

// GeoTIFF and COG, through GDAL. What costs memory is checked against the bytes that are there before it is read.
namespace terrane {

namespace {

/// No codec we accept expands further than this but for plain areas, which `free_size` leaves room for.
constexpr double max_expansion = 1100;
constexpr double free_size = 16e6;

class TiffReader {
 public:
  TiffReader(std::string_view bytes, const ReadOptions& options, Context& context)
      : bytes_(bytes), options_(options), context_(context), file_(bytes, ".tif") {}

  Dataset read() {
    refuse_named_files();
    const char* drivers[] = {"GTiff", nullptr};
    const char* open_options[] = {"GEOREF_SOURCES=INTERNAL", "NUM_THREADS=1", nullptr};
    const char* siblings[] = {nullptr};
    dataset_.reset(static_cast<GDALDataset*>(
        GDALOpenEx(file_.name().c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers, open_options, siblings)));
    if (dataset_ && !tiff_directory_complete(bytes_))
      bad("truncated", "its directory points beyond its end; send the file again");
    if (!dataset_) bad("wrong-magic", "this is no TIFF that can be read, or it is cut off; send the file again");
    check_size();
    band_ = dataset_->GetRasterBand(1);
    if (dataset_->GetRasterCount() > 2)
      context_.warn({"several-bands", options_.name, "", "the raster has several bands; the first is taken as heights",
                     "extract the band that holds heights"});
    Raster raster;
    place(raster);
    read_samples(raster);
    warn_of_voids(raster);
    Dataset out;
    out.crs = read_crs();
    out.height_unit = read_height_unit(out.crs);
    turn_north_up(raster);
    check_raster(options_, raster);
    out.surface = std::move(raster);
    return out;
  }

 private:
  [[noreturn]] void bad(std::string code, const std::string& what) const {
    bad_input(options_, std::move(code), "", what);
  }

  void refuse_named_files() const;
  void check_size();
  void place(Raster& raster);
  void read_samples(Raster& raster);
  void read_mask(Raster& raster, int first, int rows);
  void apply_no_data(Raster& raster, int first, int rows);
  void warn_of_voids(const Raster& raster) const;
  Crs read_crs();
  std::string read_height_unit(const Crs& crs) const;
  void turn_north_up(Raster& raster) const;

  std::string_view bytes_;
  const ReadOptions& options_;
  Context& context_;
  ClosedGdal closed_;
  MemoryFile file_;
  DatasetHandle dataset_;
  GDALRasterBand* band_ = nullptr;
  bool flip_rows_ = false, flip_columns_ = false;
};

/// A citation may be a whole definition of a CRS, which GDAL reads before anyone is asked.
void TiffReader::refuse_named_files() const {
  constexpr std::string_view mark = "ESRI PE String";
  constexpr std::size_t longest = 1 << 16;
  for (std::size_t at = bytes_.find(mark); at != std::string_view::npos; at = bytes_.find(mark, at + mark.size()))
    if (names_files(bytes_.substr(at, longest)))
      bad("bad-crs", "its coordinate reference system names grid files, which is not allowed");
}

void TiffReader::check_size() {
  if (dataset_->GetRasterCount() < 1) bad("no-band", "the TIFF holds no image");
  if (dataset_->GetRasterCount() > 64) bad("too-many-bands", "more than 64 bands; extract the one that holds heights");
  const GDALDataType type = dataset_->GetRasterBand(1)->GetRasterDataType();
  if (GDALDataTypeIsComplex(type)) bad("bad-type", "complex numbers are no heights");
  const char* codec = dataset_->GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE");
  const std::string compression = codec ? codec : "";
  constexpr const char* known[] = {"",          "LZW",  "DEFLATE", "PACKBITS", "LERC", "LERC_DEFLATE",
                                   "LERC_ZSTD", "ZSTD", "LZMA"};
  if (std::find(std::begin(known), std::end(known), compression) == std::end(known))
    bad("compression", "its compression is made for pictures, not heights; convert it to DEFLATE, LZW, ZSTD or none");
  const double width = dataset_->GetRasterXSize(), height = dataset_->GetRasterYSize();
  const double bands = dataset_->GetRasterCount(), size = GDALGetDataTypeSizeBytes(type);
  if (width * height > static_cast<double>(options_.max_samples))
    check_count(options_, static_cast<std::size_t>(width * height), options_.max_samples, "samples");
  int block_width = 0, block_height = 0;
  dataset_->GetRasterBand(1)->GetBlockSize(&block_width, &block_height);
  // Pixel-interleaved blocks hold every band.
  const double image = width * height * size, block = static_cast<double>(block_width) * block_height * size * bands;
  const double room = std::max(free_size, max_expansion * static_cast<double>(bytes_.size()));
  if (image > room || block > room)
    bad("truncated", "it announces " + std::to_string(static_cast<long long>(width)) + " x " +
                         std::to_string(static_cast<long long>(height)) + " samples, which " +
                         std::to_string(bytes_.size()) + " bytes cannot hold; send the file again");
  if (compression.empty() && image > static_cast<double>(bytes_.size()))
    bad("truncated",
        "the file is shorter than its samples: cut off, or written with blocks left out; send it again, whole");
}

void TiffReader::place(Raster& raster) {
  raster.width = dataset_->GetRasterXSize();
  raster.height = dataset_->GetRasterYSize();
  double t[6];
  if (dataset_->GetGeoTransform(t) != CE_None)
    bad("no-georeference", "the TIFF does not say where it lies (no geotransform inside); georeference it first");
  for (double value : t)
    if (!std::isfinite(value)) bad("bad-number", "its geotransform holds a number that is not finite");
  if (t[2] != 0 || t[4] != 0)
    bad("rotated", "the raster is rotated against its coordinate system; warp it to north up first");
  if (t[1] == 0 || t[5] == 0) bad("bad-number", "its cells have no size");
  const char* point = dataset_->GetMetadataItem("AREA_OR_POINT");
  // With GTIFF_POINT_GEO_IGNORE the tie point of a point raster is its first sample itself: nothing is rounded.
  const double half = point && CPLString(point).toupper() == "POINT" ? 0 : 0.5;
  raster.dx = std::fabs(t[1]);
  raster.dy = std::fabs(t[5]);
  flip_columns_ = t[1] < 0;
  flip_rows_ = t[5] > 0;
  raster.x0 = t[0] + (flip_columns_ ? raster.width - 1 + half : half) * t[1];
  raster.y0 = t[3] + (flip_rows_ ? raster.height - 1 + half : half) * t[5];
  if (!std::isfinite(raster.x0 + raster.width * raster.dx) || !std::isfinite(raster.y0 - raster.height * raster.dy))
    bad("bad-number", "its extent is not finite");
}

void TiffReader::read_samples(Raster& raster) {
  const std::size_t width = raster.width;
  raster.samples.resize(width * raster.height);
  int block_width = 0, block_height = 0;
  band_->GetBlockSize(&block_width, &block_height);
  const int rows_at_once =
      std::max(1, static_cast<int>(std::max<std::size_t>(1, (1 << 20) / width) / block_height)) * block_height;
  const bool masked = (band_->GetMaskFlags() & (GMF_PER_DATASET | GMF_ALPHA)) != 0;
  for (int first = 0; first < raster.height; first += rows_at_once) {
    context_.progress("read", static_cast<double>(first) / raster.height);
    const int rows = std::min(rows_at_once, raster.height - first);
    if (band_->RasterIO(GF_Read, 0, first, raster.width, rows, raster.samples.data() + width * first, raster.width,
                        rows, GDT_Float64, 0, 0, nullptr) != CE_None)
      bad_input(options_, "truncated", "row " + std::to_string(first),
                "samples cannot be read; the file is cut off or damaged, send it again");
    apply_no_data(raster, first, rows);
    if (masked) read_mask(raster, first, rows);
  }
}

void TiffReader::apply_no_data(Raster& raster, int first, int rows) {
  int has_no_data = 0, has_scale = 0, has_offset = 0;
  const double no_data = band_->GetNoDataValue(&has_no_data);
  double scale = band_->GetScale(&has_scale), offset = band_->GetOffset(&has_offset);
  if (!has_scale) scale = 1;
  if (!has_offset) offset = 0;
  if (!std::isfinite(scale) || !std::isfinite(offset) || scale == 0)
    bad("bad-number", "its scale or offset is no usable number");
  const bool single = band_->GetRasterDataType() == GDT_Float32;
  const std::size_t width = raster.width, begin = width * first, end = begin + width * rows;
  for (std::size_t k = begin; k < end; ++k) {
    double& z = raster.samples[k];
    if (std::isnan(z)) continue;
    if (has_no_data && (z == no_data || (single && static_cast<float>(z) == static_cast<float>(no_data)))) {
      z = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    z = z * scale + offset;
    if (!std::isfinite(z))
      bad_input(options_, "not-finite",
                "sample in column " + std::to_string(k % width) + ", row " + std::to_string(k / width),
                "the height is infinite; declare such samples as NoData");
  }
}

/// What programs write where they know no height, left undeclared, makes pits that no one means.
void TiffReader::warn_of_voids(const Raster& raster) const {
  double low = INFINITY;
  for (const double z : raster.samples) low = z < low ? z : low;
  constexpr double usual[] = {-9999, -99999, -32767, -32768, std::numeric_limits<float>::lowest()};
  const double scale = band_->GetScale(), offset = band_->GetOffset();
  const double* const raw =
      std::find_if(std::begin(usual), std::end(usual), [&](double value) { return value * scale + offset == low; });
  if (raw == std::end(usual)) return;
  context_.warn({"undeclared-voids", options_.name, "",
                 std::to_string(std::count(raster.samples.begin(), raster.samples.end(), low)) + " samples are " +
                     shortest(*raw) + ", which mostly stands for voids; the file does not say so, and they are heights",
                 "if they are voids, declare the value as NoData"});
}

void TiffReader::read_mask(Raster& raster, int first, int rows) {
  const std::size_t width = raster.width;
  std::vector<GByte> mask(width * rows);
  if (band_->GetMaskBand()->RasterIO(GF_Read, 0, first, raster.width, rows, mask.data(), raster.width, rows, GDT_Byte,
                                     0, 0, nullptr) != CE_None)
    bad_input(options_, "truncated", "row " + std::to_string(first),
              "the mask cannot be read; the file is cut off or damaged, send it again");
  for (std::size_t k = 0; k < mask.size(); ++k)
    if (mask[k] == 0) raster.samples[width * first + k] = std::numeric_limits<double>::quiet_NaN();
}

Crs TiffReader::read_crs() {
  const OGRSpatialReference* srs = dataset_->GetSpatialRef();
  if (!srs || srs->IsEmpty()) return {};
  char* text = nullptr;
  const char* format[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  const std::string wkt = srs->exportToWkt(&text, format) == OGRERR_NONE && text ? text : "";
  CPLFree(text);
  return declared_crs(wkt, options_, context_);
}

/// A band may say its own unit. Where that is the unit of the CRS it says no more: `crs` overrules both.
std::string TiffReader::read_height_unit(const Crs& crs) const {
  const std::string said = band_->GetUnitType() ? band_->GetUnitType() : "", word = lower(said);
  const auto is = [&](std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), word) != names.end();
  };
  const char* const unit = is({"m", "metre", "meter", "metres", "meters"})                                 ? "m"
                           : is({"ft", "foot", "feet"})                                                    ? "ft"
                           : is({"ftus", "ft us", "us-ft", "foot_us", "us survey foot", "us_survey_foot"}) ? "ftUS"
                                                                                                           : nullptr;
  if (unit) return crs.known() && crs.height_unit() == unit ? "" : unit;
  if (!word.empty() && word != "unknown")
    context_.warn({"unknown-unit", options_.name, "",
                   "the raster says its heights are in '" + one_line(said) +
                       "', which is no unit that is known here; they were taken as they are",
                   "bring them to the unit of the CRS if they are not in it"});
  return "";
}

void TiffReader::turn_north_up(Raster& raster) const {
  const auto row = [&](int j) { return raster.samples.begin() + static_cast<std::ptrdiff_t>(j) * raster.width; };
  if (flip_rows_)
    for (int j = 0; j < raster.height / 2; ++j)
      std::swap_ranges(row(j), row(j) + raster.width, row(raster.height - 1 - j));
  if (flip_columns_)
    for (int j = 0; j < raster.height; ++j) std::reverse(row(j), row(j) + raster.width);
}

}  // namespace

Format geotiff_format() {
  return {"tif",
          {".tif", ".tiff"},
          "image/tiff",
          "GeoTIFF or COG with heights in its first band, NoData as voids.",
          [](Source source, const ReadOptions& options, Context& context) {
            return TiffReader(source.rest(), options, context).read();
          },
          nullptr,
          [](std::string_view head) {
            using namespace std::string_view_literals;
            return head.starts_with("II*\0"sv) || head.starts_with("MM\0*"sv) || head.starts_with("II+\0"sv) ||
                   head.starts_with("MM\0+"sv);
          }};
}

}  // namespace terrane
