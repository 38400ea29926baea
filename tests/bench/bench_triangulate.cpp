// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdio>
#include <ctime>

#include "core/error.hpp"
#include "core/triangulate.hpp"
#include "tests/bench/bench.hpp"

namespace terrane::bench {

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
    if (result.error > max_error) throw Error(ErrorKind::internal, "bound", "the bound does not hold");
  }
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
