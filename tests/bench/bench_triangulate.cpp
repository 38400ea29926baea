// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

#include "core/error.hpp"
#include "core/rasterize.hpp"
#include "core/triangulate.hpp"
#include "tests/bench/bench.hpp"

namespace terrane::bench {
namespace {

/// The largest distance of a sample from the surface, by code that had no part in making it; infinite where a raster
/// without voids has a hole.
double largest_error(const Tin& tin, const Raster& dem) {
  Context context;
  const Raster made = terrane::rasterize(tin, dem, context);
  const auto is_void = [](double z) { return std::isnan(z); };
  const bool voids = std::any_of(dem.samples.begin(), dem.samples.end(), is_void);
  double largest = 0;
  for (std::size_t k = 0; k < dem.samples.size(); ++k) {
    const double error = std::fabs(made.samples[k] - dem.samples[k]);
    if (!is_void(error) || !voids) largest = is_void(error) ? INFINITY : std::max(largest, error);
  }
  return largest;
}

}  // namespace

/// A raster in memory to a TIN whose bound was measured on every sample.
int triangulate(Words words) {
  const int threads = static_cast<int>(words.number("--threads", 1));
  const int repeat = std::max(1, static_cast<int>(words.number("--repeat", 3)));
  const double max_error = words.number("--max-error", 1);
  const auto files = words.files(1, "triangulate DEM.tif [--max-error E] [--threads N] [--repeat R]");
  const Raster dem = read_raster(files[0]);
  std::vector<double> seconds, cpu;
  Triangulated result;
  for (int r = 0; r < repeat; ++r) {
    result = {};
    Context context;
    context.threads = threads;
    const double start = now();
    const std::clock_t clock = std::clock();
    result = terrane::triangulate(dem, {.max_error = max_error}, context);
    seconds.push_back(now() - start);
    cpu.push_back(static_cast<double>(std::clock() - clock) / CLOCKS_PER_SEC);
  }
  // What rasterize rounds is far below a billionth.
  if (!(std::max(result.error, largest_error(result.tin, dem) - 1e-9) <= max_error))
    throw Error(ErrorKind::internal, "bound", "the bound does not hold");
  const double best = *std::min_element(seconds.begin(), seconds.end());
  std::printf(
      "{\"seconds\":%.6f,\"best_seconds\":%.6f,\"best_cpu_seconds\":%.6f,\"samples_per_second\":%.0f,"
      "\"points\":%zu,\"faces\":%zu,\"error\":%.9g,\"threads\":%d,\"repeat\":%d}\n",
      median(seconds), best, *std::min_element(cpu.begin(), cpu.end()),
      static_cast<double>(dem.samples.size()) / median(seconds), result.tin.vertices.size(), result.tin.faces.size(),
      result.error, threads, repeat);
  return 0;
}

}  // namespace terrane::bench
