// SPDX-License-Identifier: GPL-3.0-or-later
#include <malloc.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "core/error.hpp"
#include "core/overlay.hpp"
#include "core/predicates.hpp"
#include "tests/bench/bench.hpp"

namespace terrane::bench {

namespace {

/// Resident memory now, and its peak since reset_peak().
std::size_t status_bytes(const char *key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind(key, 0) == 0)
      return std::strtoull(line.c_str() + std::string(key).size() + 1, nullptr,
                           10) *
             1024;
  return 0;
}
void reset_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

} // namespace

/// From triangle soup to verified overlay, cold unless --warm: memory is given
/// back between rounds.
int overlay(Words words) {
  const int threads = static_cast<int>(words.number("--threads", 1));
  const int repeat = std::max(1, static_cast<int>(words.number("--repeat", 3)));
  const bool warm = words.flag("--warm");
  const auto files =
      words.files(2, "overlay A.ply B.ply [--threads N] [--repeat R] [--warm]");
  const Tin a = read_tin(files[0]), b = read_tin(files[1]);
  std::vector<double> prepare, refine, verify, total;
  std::size_t faces = 0, peak = 0;
  Index regions = 0;
  for (int r = 0; r < repeat; ++r) {
    if (!warm)
      malloc_trim(0);
    reset_peak();
    const std::size_t before = status_bytes("VmRSS:");
    Context context;
    context.threads = threads;
    const double t0 = now();
    const Tin sorted_a = canonical(a), sorted_b = canonical(b);
    const double t1 = now();
    const Overlay result = terrane::overlay(sorted_a, sorted_b, {}, context);
    const double t2 = now();
    std::size_t bad = 0; // once more, on what would be returned
    for (const Face &f : result.faces)
      bad += orientation(result.points[f[0]], result.points[f[1]],
                         result.points[f[2]]) <= 0;
    const double t3 = now();
    if (bad != 0)
      throw Error(ErrorKind::internal, "verify", "faces that are not positive");
    prepare.push_back(t1 - t0);
    refine.push_back(t2 - t1);
    verify.push_back(t3 - t2);
    total.push_back(t3 - t0);
    faces = result.faces.size();
    regions = result.rounding.regions;
    peak = std::max(peak, status_bytes("VmHWM:") -
                              std::min(before, status_bytes("VmHWM:")));
  }
  std::printf("{\"prepare_seconds\":%.6f,\"overlay_seconds\":%.6f,\"verify_"
              "seconds\":%.6f,\"total_seconds\":%.6f,"
              "\"faces\":%zu,\"regions\":%d,\"peak_bytes\":%zu,\"threads\":%d,"
              "\"repeat\":%d}\n",
              median(prepare), median(refine), median(verify), median(total),
              faces, regions, peak, threads, repeat);
  return 0;
}

} // namespace terrane::bench
