// SPDX-License-Identifier: GPL-3.0-or-later
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "core/error.hpp"
#include "tests/bench/bench.hpp"

namespace terrane::bench {
namespace {

using Complex = std::complex<double>;

/// The inverse Fourier transform in place, not scaled, of `n` numbers `stride` apart; n is a power of two.
void transform(Complex* values, std::size_t n, std::size_t stride, std::vector<Complex>& row) {
  row.resize(n);
  for (std::size_t i = 0, j = 0; i < n; ++i) {
    row[j] = values[i * stride];
    std::size_t bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
  }
  for (std::size_t half = 1; half < n; half *= 2) {
    const Complex turn = std::polar(1.0, std::numbers::pi / static_cast<double>(half));
    Complex factor = 1;
    for (std::size_t k = 0; k < half; ++k, factor *= turn)
      for (std::size_t i = k; i < n; i += 2 * half) {
        const Complex a = row[i], b = factor * row[i + half];
        row[i] = a + b;
        row[i + half] = a - b;
      }
  }
  for (std::size_t i = 0; i < n; ++i) values[i * stride] = row[i];
}

/// Heights 0 to 2000 whose spectrum falls with frequency to the power -2.2, periodic: the last row and column repeat
/// the first.
std::vector<float> fractal(std::size_t cells, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; };
  const auto frequency = [&](std::size_t i) {
    return (i <= cells / 2 ? static_cast<double>(i) : static_cast<double>(i) - static_cast<double>(cells)) /
           static_cast<double>(cells);
  };
  std::vector<Complex> field(cells * cells), row;
  for (std::size_t j = 0; j < cells; ++j)
    for (std::size_t i = 0; i < cells; ++i) {
      const double square = frequency(i) * frequency(i) + frequency(j) * frequency(j);
      const double size = std::sqrt(-2 * std::log(uniform())), angle = 2 * std::numbers::pi * uniform();
      if (square > 0) field[j * cells + i] = std::polar(size * std::pow(square, -1.1), angle);
    }
  for (std::size_t j = 0; j < cells; ++j) transform(&field[j * cells], cells, 1, row);
  for (std::size_t i = 0; i < cells; ++i) transform(&field[i], cells, cells, row);
  const auto [low, high] = std::minmax_element(field.begin(), field.end(),
                                               [](const Complex& a, const Complex& b) { return a.real() < b.real(); });
  const double bottom = low->real(), scale = 2000 / (high->real() - bottom);
  std::vector<float> heights;
  for (std::size_t j = 0; j <= cells; ++j)
    for (std::size_t i = 0; i <= cells; ++i)
      heights.push_back(static_cast<float>((field[j % cells * cells + i % cells].real() - bottom) * scale));
  return heights;
}

}  // namespace

/// A fractal DEM as a GeoTIFF of floats: cells of 10 m in UTM 33N.
int dem(Words words) {
  const int size = static_cast<int>(words.number("--size", 4097));
  const auto seed = static_cast<std::uint64_t>(words.number("--seed", 3));
  const auto files = words.files(1, "dem OUT.tif [--size SAMPLES] [--seed S]");
  if (size < 5 || size > 16385 || ((size - 1) & (size - 2)) != 0)
    throw Error(ErrorKind::usage, "usage", "--size must be a power of two and one, 5 to 16385");
  std::vector<float> heights = fractal(static_cast<std::size_t>(size) - 1, seed);
  GDALAllRegister();
  OGRSpatialReference crs;
  char* wkt = nullptr;
  if (crs.importFromEPSG(32633) != OGRERR_NONE || crs.exportToWkt(&wkt) != OGRERR_NONE)
    throw Error(ErrorKind::internal, "crs", "EPSG:32633 is not known here");
  double lattice[6] = {500000, 10, 0, 5000000, 0, -10};
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  GDALDataset* file = driver->Create(files[0].c_str(), size, size, 1, GDT_Float32, nullptr);
  const bool written = file && file->SetGeoTransform(lattice) == CE_None && file->SetProjection(wkt) == CE_None &&
                       file->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, size, size, heights.data(), size, size,
                                                        GDT_Float32, 0, 0, nullptr) == CE_None;
  if (file) GDALClose(file);
  CPLFree(wkt);
  if (!written) throw Error(ErrorKind::output, "not-stored", files[0] + " cannot be written");
  std::printf("{\"samples\":%zu}\n", heights.size());
  return 0;
}

}  // namespace terrane::bench
