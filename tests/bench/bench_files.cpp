// SPDX-License-Identifier: GPL-3.0-or-later
#include <malloc.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "core/error.hpp"
#include "tests/bench/bench.hpp"

namespace terrane::bench {
namespace {

/// Of all threads: what the machine did for us, whoever else it worked for.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Seconds, the best of the runs, and the most memory beyond what was there before.
struct Cost {
  double seconds = 1e300, cpu = 1e300;
  std::size_t peak = 0;

  template <class F>
  void measure(F&& work) {
    malloc_trim(0);
    reset_peak();
    const std::size_t before = status_bytes("VmRSS:");
    const double start = now(), cpu_start = cpu_seconds();
    work();
    seconds = std::min(seconds, now() - start);
    cpu = std::min(cpu, cpu_seconds() - cpu_start);
    peak = std::max(peak, status_bytes("VmHWM:") - std::min(before, status_bytes("VmHWM:")));
  }

  void print(const char* what, double bytes, double mesh) const {
    std::printf("\"%s\":{\"seconds\":%.6f,\"cpu_seconds\":%.6f,\"bytes_per_second\":%.0f,\"peak_per_mesh\":%.3f}", what,
                seconds, cpu, bytes / seconds, static_cast<double>(peak) / mesh);
  }
};

}  // namespace

/// A mesh to a file of each format and back, the mesh itself counted in the memory of reading.
int files(Words words) {
  const int threads = static_cast<int>(words.number("--threads", 1));
  const int repeat = std::max(1, static_cast<int>(words.number("--repeat", 3)));
  const auto paths = words.files(2, "files MESH FOLDER [--threads N] [--repeat R]");
  const Tin tin = read_tin(paths[0]);
  const double mesh = static_cast<double>(tin.vertices.size() * sizeof(Point) + tin.faces.size() * sizeof(Face));
  std::printf("{\"faces\":%zu,\"mesh_bytes\":%.0f,\"threads\":%d,\"repeat\":%d", tin.faces.size(), mesh, threads, repeat);
  for (const Format& format : formats()) {
    if (!format.read || !format.write) continue;
    const std::string path = paths[1] + "/terrane-bench-files" + format.extensions.front();
    Cost write, read;
    double bytes = 0;
    for (int r = 0; r < repeat; ++r) {
      Context context;
      context.threads = threads;
      write.measure([&] {
        std::ofstream file(path, std::ios::binary);
        format.write(tin, {}, {}, [&](std::string_view piece) { file.write(piece.data(), piece.size()); }, context);
        if (!file.flush()) throw Error(ErrorKind::output, "not-stored", path + " cannot be written");
      });
      bytes = static_cast<double>(std::filesystem::file_size(path));
      Dataset again;
      read.measure([&] {
        std::ifstream file(path, std::ios::binary);
        const auto fill = [&](char* to, std::size_t size) {
          return static_cast<std::size_t>(file.read(to, static_cast<std::streamsize>(size)).gcount());
        };
        again = format.read(Source(fill, static_cast<std::size_t>(bytes)), {.name = path}, context);
      });
      if (std::get<Tin>(again.surface) != tin) throw Error(ErrorKind::internal, "files", path + " came back changed");
    }
    std::filesystem::remove(path);
    std::printf(",\"%s\":{\"bytes\":%.0f,", format.name.c_str(), bytes);
    write.print("write", bytes, mesh);
    std::printf(",");
    read.print("read", bytes, mesh);
    std::printf("}");
  }
  std::printf("}\n");
  return 0;
}

}  // namespace terrane::bench
