// SPDX-License-Identifier: GPL-3.0-or-later
#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.hpp"
#include "core/overlay.hpp"
#include "core/parallel.hpp"
#include "core/predicates.hpp"
#include "tests/bench/bench.hpp"

namespace terrane::bench {

namespace {

struct Usage {
  double cpu_seconds;
  std::size_t page_faults;
};
Usage usage() {
  rusage r;
  getrusage(RUSAGE_SELF, &r);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {seconds(r.ru_utime) + seconds(r.ru_stime), static_cast<std::size_t>(r.ru_minflt)};
}

}  // namespace

/// From triangle soup to overlay, every face of which the overlay itself has judged exactly on the doubles returned;
/// the second look by this program is timed apart ("verify"). Cold unless --warm: memory is given back between rounds.
/// The peak is that of the overlay alone, its inputs excluded.
int overlay(Words words) {
  const int threads = static_cast<int>(words.number("--threads", 1));
  const int repeat = std::max(1, static_cast<int>(words.number("--repeat", 3)));
  const bool warm = words.flag("--warm");
  const auto files = words.files(2, "overlay A.ply B.ply [--threads N] [--repeat R] [--warm]");
  const Tin tins[2] = {read_tin(files[0]), read_tin(files[1])};
  std::vector<double> prepare, refine, verify, total, cpu;
  std::vector<double> stages;  // of the overlay, each at its quickest
  std::size_t faces = 0, peak = 0, faults = 0;
  RoundingReport rounding;
  for (int r = 0; r < repeat; ++r) {
    if (!warm) malloc_trim(0);
    Tin sorted[2] = {tins[0], tins[1]};  // as a reader would have left them
    Context context;
    context.threads = threads;
    std::vector<double> reached;  // when the overlay said how far it is
    context.on_progress = [&](std::string_view, double) { reached.push_back(now()); };
    const Usage before = usage();
    const double t0 = now();
    parallel_tasks(context, 2, [&](std::size_t i) { sorted[i] = canonical(std::move(sorted[i])); });
    const double t1 = now();
    reset_peak();
    const std::size_t inputs = status_bytes("VmRSS:");
    const double t2 = now();
    const Overlay result = terrane::overlay(sorted[0], sorted[1], {}, context);
    const double t3 = now();
    std::size_t bad = 0;  // once more, on what would be returned
    for (const Face& f : result.faces)
      bad += orientation(result.points[f[0]], result.points[f[1]], result.points[f[2]]) <= 0;
    const double t4 = now();
    const Usage after = usage();
    if (bad != 0) throw Error(ErrorKind::internal, "verify", "faces that are not positive");
    prepare.push_back(t1 - t0);
    refine.push_back(t3 - t2);
    verify.push_back(t4 - t3);
    total.push_back(t1 - t0 + t3 - t2);
    stages.resize(reached.size() - 1, INFINITY);
    for (std::size_t i = 0; i + 1 < reached.size(); ++i) stages[i] = std::min(stages[i], reached[i + 1] - reached[i]);
    cpu.push_back(after.cpu_seconds - before.cpu_seconds);
    faults = after.page_faults - before.page_faults;
    faces = result.faces.size();
    rounding = result.rounding;
    peak = std::max(peak, status_bytes("VmHWM:") - std::min(inputs, status_bytes("VmHWM:")));
  }
  std::printf(
      "{\"prepare_seconds\":%.6f,\"overlay_seconds\":%.6f,\"verify_seconds\":%.6f,\"total_seconds\":%.6f,"
      "\"cpu_seconds\":%.6f,\"faces\":%zu,\"regions\":%d,\"merges\":%d,\"flips\":%d,\"kinetic\":%d,"
      "\"peak_bytes\":%zu,\"page_faults\":%zu,\"threads\":%d,\"repeat\":%d,\"stage_seconds\":[",
      median(prepare), median(refine), median(verify), median(total), median(cpu), faces, rounding.regions,
      rounding.merges, rounding.flips, rounding.kinetic, peak, faults, threads, repeat);
  for (std::size_t i = 0; i < stages.size(); ++i) std::printf("%s%.6f", i == 0 ? "" : ",", stages[i]);
  std::printf("]}\n");
  return 0;
}

}  // namespace terrane::bench
