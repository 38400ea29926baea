// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "core/error.hpp"
#include "support/terrains.hpp"
#include "tests/bench/bench.hpp"

namespace terrane::bench {
namespace {

void write_mesh(const Tin& tin, const std::string& path) {
  const Format* format = format_of_file(path);
  if (!format || !format->write) throw Error(ErrorKind::usage, "unknown-format", path + ": not a format we write");
  std::ofstream file(path, std::ios::binary);
  Context context;
  format->write(
      tin, {}, {}, [&](std::string_view piece) { file.write(piece.data(), piece.size()); }, context);
  if (!file.flush()) throw Error(ErrorKind::output, "not-stored", path + " cannot be written");
}

/// What the baselines read: the numbers of vertices and faces as int32, all x, all y, all z as doubles, three int32 a
/// face; in the machine's byte order.
void write_columns(const Tin& tin, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  const auto put = [&](const void* at, std::size_t bytes) { file.write(static_cast<const char*>(at), bytes); };
  const std::int32_t counts[2] = {static_cast<std::int32_t>(tin.vertices.size()),
                                  static_cast<std::int32_t>(tin.faces.size())};
  put(counts, sizeof counts);
  for (double Point::*coordinate : {&Point::x, &Point::y, &Point::z})
    for (const Point& p : tin.vertices) put(&(p.*coordinate), sizeof(double));
  put(tin.faces.data(), tin.faces.size() * sizeof(Face));
  if (!file.flush()) throw Error(ErrorKind::output, "not-stored", path + " cannot be written");
}

}  // namespace

/// A random Delaunay terrain, or a changed copy of it, as a file. The same options give the same bytes everywhere.
int mesh(Words words) {
  const int points = static_cast<int>(words.number("--points", 250000));
  const auto seed = static_cast<std::uint64_t>(words.number("--seed", 1));
  const double x = words.number("--x", 0), y = words.number("--y", 0), jitter = words.number("--jitter", 0);
  const bool edited = words.flag("--edited"), shuffled = words.flag("--shuffled"), columns = words.flag("--columns");
  const auto files = words.files(1,
                                 "mesh OUT.ply [--points N] [--seed S] [--x DX] [--y DY] [--edited] [--jitter E] "
                                 "[--shuffled] [--columns]: --columns writes OUT.bin, too, for the baselines");
  if (points < 16) throw Error(ErrorKind::usage, "usage", "--points must be 16 or more");
  Tin tin = support::random_terrain(points, seed);
  if (edited) tin = support::edited(std::move(tin), 0.02);
  tin = support::shifted(std::move(tin), x, y);
  if (jitter > 0) tin = support::jittered(std::move(tin), jitter, true);
  if (shuffled) tin = support::shuffled(tin, seed);
  write_mesh(tin, files[0]);
  if (columns) write_columns(tin, std::filesystem::path(files[0]).replace_extension(".bin"));
  std::printf("{\"vertices\":%zu,\"faces\":%zu}\n", tin.vertices.size(), tin.faces.size());
  return 0;
}

}  // namespace terrane::bench
