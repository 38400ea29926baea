// SPDX-License-Identifier: GPL-3.0-or-later
// terrane-bench WHAT FILES [options]: times one thing, in memory, and prints only JSON; reading the files is not timed.
// `mesh` and `dem` make the files.
#include <cstdio>
#include <map>
#include <string>

#include "core/error.hpp"
#include "tests/bench/bench.hpp"

namespace {

using namespace terrane;

int run(int argc, char** argv) {
  static const std::map<std::string, int (*)(bench::Words)> subcommands{
      {"dem", bench::dem},
      {"files", bench::files},
      {"memory", bench::memory},
      {"mesh", bench::mesh},
      {"overlay", bench::overlay},
      {"rasterize", bench::rasterize},
      {"triangulate", bench::triangulate}};
  const auto it = subcommands.find(argc > 1 ? argv[1] : "");
  if (it != subcommands.end()) return it->second({argc - 2, argv + 2});
  std::string names;
  for (const auto& [name, function] : subcommands) names += (names.empty() ? "" : "|") + name;
  throw Error(ErrorKind::usage, "usage", "usage: terrane-bench " + names + " FILES [options]");
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
