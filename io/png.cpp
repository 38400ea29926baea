// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/error.hpp"
#include "io/format.hpp"
#include "io/gdal.hpp"

namespace terrane {

namespace {

[[noreturn]] void failed() { throw Error(ErrorKind::internal, "png", "the picture could not be written as PNG"); }

}  // namespace

std::string write_png(const Picture& picture) {
  const std::size_t pixels = static_cast<std::size_t>(picture.width) * picture.height;
  if (picture.width <= 0 || picture.height <= 0 || picture.rgba.size() != 4 * pixels)
    throw Error(ErrorKind::internal, "png", "a picture without pixels");
  const ClosedGdal closed;
  GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("MEM");
  GDALDriver* png = GetGDALDriverManager()->GetDriverByName("PNG");
  if (!memory || !png) failed();
  const DatasetHandle source(memory->Create("", picture.width, picture.height, 4, GDT_Byte, nullptr));
  if (!source) failed();
  auto* bytes = const_cast<std::uint8_t*>(picture.rgba.data());
  if (source->RasterIO(GF_Write, 0, 0, picture.width, picture.height, bytes, picture.width, picture.height, GDT_Byte, 4,
                       nullptr, 4, static_cast<GSpacing>(4) * picture.width, 1, nullptr) != CE_None)
    failed();
  constexpr GDALColorInterp colours[4] = {GCI_RedBand, GCI_GreenBand, GCI_BlueBand, GCI_AlphaBand};
  for (int band = 0; band < 4; ++band) source->GetRasterBand(band + 1)->SetColorInterpretation(colours[band]);
  const MemoryFile file(".png");
  {
    const DatasetHandle written(png->CreateCopy(file.name().c_str(), source.get(), false, nullptr, nullptr, nullptr));
    if (!written) failed();
  }
  std::string out = file.contents();
  if (out.empty()) failed();
  return out;
}

}  // namespace terrane
