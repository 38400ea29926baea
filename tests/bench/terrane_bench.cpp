// SPDX-License-Identifier: GPL-3.0-or-later
// terrane-bench overlay A.ply B.ply [--threads N] [--repeat R] [--warm]: prints only JSON. Reading the files is not
// timed.
#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "core/overlay.hpp"
#include "core/predicates.hpp"
#include "io/format.hpp"

namespace {

using namespace terrane;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

Tin read_tin(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  if (!(bytes << file.rdbuf())) throw Error(ErrorKind::input, "unreadable", path + " cannot be read");
  const Format* format = format_of_file(path);
  if (!format || !format->read) throw Error(ErrorKind::usage, "unknown-format", path + ": not a format we read");
  Context context;
  Dataset dataset = format->read(bytes.str(), {.name = path}, context);
  if (!std::holds_alternative<Tin>(dataset.surface)) throw Error(ErrorKind::usage, "not-a-tin", path + " is no TIN");
  return std::get<Tin>(std::move(dataset.surface));
}

/// Resident memory now, and its peak since reset_peak().
std::size_t status_bytes(const char* key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind(key, 0) == 0) return std::strtoull(line.c_str() + std::string(key).size() + 1, nullptr, 10) * 1024;
  return 0;
}
void reset_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

int run(int argc, char** argv) {
  std::vector<std::string> files;
  int threads = 1, repeat = 3;
  bool warm = false;
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--threads" && i + 1 < argc)
      threads = std::atoi(argv[++i]);
    else if (word == "--repeat" && i + 1 < argc)
      repeat = std::max(1, std::atoi(argv[++i]));
    else if (word == "--warm")
      warm = true;
    else
      files.push_back(word);
  }
  if (argc < 2 || std::string(argv[1]) != "overlay" || files.size() != 2) {
    std::fprintf(stderr, "usage: terrane-bench overlay A.ply B.ply [--threads N] [--repeat R] [--warm]\n");
    return 2;
  }
  const Tin a = read_tin(files[0]), b = read_tin(files[1]);
  std::vector<double> prepare, refine, verify, total;
  std::size_t faces = 0, peak = 0;
  Index regions = 0;
  for (int r = 0; r < repeat; ++r) {
    if (!warm) malloc_trim(0);
    reset_peak();
    const std::size_t before = status_bytes("VmRSS:");
    Context context;
    context.threads = threads;
    const double t0 = now();
    const Tin sorted_a = canonical(a), sorted_b = canonical(b);
    const double t1 = now();
    const Overlay result = overlay(sorted_a, sorted_b, {}, context);
    const double t2 = now();
    std::size_t bad = 0;  // once more, on what would be returned
    for (const Face& f : result.faces)
      bad += orientation(result.points[f[0]], result.points[f[1]], result.points[f[2]]) <= 0;
    const double t3 = now();
    if (bad != 0) throw Error(ErrorKind::internal, "verify", "faces that are not positive");
    prepare.push_back(t1 - t0);
    refine.push_back(t2 - t1);
    verify.push_back(t3 - t2);
    total.push_back(t3 - t0);
    faces = result.faces.size();
    regions = result.rounding.regions;
    peak = std::max(peak, status_bytes("VmHWM:") - std::min(before, status_bytes("VmHWM:")));
  }
  std::printf(
      "{\"prepare_seconds\":%.6f,\"overlay_seconds\":%.6f,\"verify_seconds\":%.6f,\"total_seconds\":%.6f,"
      "\"faces\":%zu,\"regions\":%d,\"peak_bytes\":%zu,\"threads\":%d,\"repeat\":%d}\n",
      median(prepare), median(refine), median(verify), median(total), faces, regions, peak, threads, repeat);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const Error& error) {
    std::fprintf(stderr, "terrane-bench: %s\n", error.what());
    return error.kind == ErrorKind::usage ? 2 : error.kind == ErrorKind::input ? 3 : 5;
  }
}
