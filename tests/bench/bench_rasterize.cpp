// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

#include "core/rasterize.hpp"
#include "tests/bench/bench.hpp"

namespace terrane::bench {

/// A TIN in memory to the heights of a square raster over its box, its memory taken anew each time.
int rasterize(Words words) {
  const int threads = static_cast<int>(words.number("--threads", 1));
  const int repeat = std::max(1, static_cast<int>(words.number("--repeat", 3)));
  const int size = std::max(2, static_cast<int>(words.number("--size", 4097)));
  const auto files = words.files(1, "rasterize TIN.ply [--size SAMPLES] [--threads N] [--repeat R]");
  const Tin tin = read_tin(files[0]);
  const Box box = bounds(tin);
  const Raster lattice{
      size, size, box.xmin, box.ymax, (box.xmax - box.xmin) / (size - 1), (box.ymax - box.ymin) / (size - 1), {}};
  std::vector<double> seconds, cpu;
  std::size_t covered = 0;
  for (int r = 0; r < repeat; ++r) {
    Context context;
    context.threads = threads;
    const double start = now();
    const std::clock_t clock = std::clock();
    const Raster raster = terrane::rasterize(tin, lattice, context);
    seconds.push_back(now() - start);
    cpu.push_back(static_cast<double>(std::clock() - clock) / CLOCKS_PER_SEC);
    covered = std::count_if(raster.samples.begin(), raster.samples.end(), [](double z) { return !std::isnan(z); });
  }
  const double cells = static_cast<double>(size) * size, core = *std::min_element(cpu.begin(), cpu.end());
  std::printf(
      "{\"seconds\":%.6f,\"best_seconds\":%.6f,\"best_cpu_seconds\":%.6f,\"cells_per_second_and_core\":%.0f,"
      "\"faces\":%zu,\"cells\":%.0f,\"covered\":%zu,\"threads\":%d,\"repeat\":%d}\n",
      median(seconds), *std::min_element(seconds.begin(), seconds.end()), core, cells / core, tin.faces.size(), cells,
      covered, threads, repeat);
  return 0;
}

}  // namespace terrane::bench
