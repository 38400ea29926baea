// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "io/format.hpp"

// What the subcommands of terrane-bench share. Each times one thing in memory, or makes a file to be timed,
// and prints one line of JSON.
namespace terrane::bench {

/// Words of a subcommand: files, and `--name value` or `--name` for options.
class Words {
 public:
  Words(int argc, char** argv) : words_(argv, argv + argc) {}

  /// The value of an option, which is taken out; `otherwise` when it was not given. Throws Error{usage} where it is no
  /// number.
  double number(const std::string& name, double otherwise);
  bool flag(const std::string& name);
  /// What is left. Throws Error{usage} with `usage` unless these are `count` files.
  std::vector<std::string> files(std::size_t count, const std::string& usage) const;
  const std::vector<std::string>& all() const { return words_; }

 private:
  std::vector<std::string> words_;
};

double now();
double median(std::vector<double> values);

/// Of this process, by its name in /proc: "VmRSS:" is resident memory now, "VmHWM:" its peak since reset_peak().
std::size_t status_bytes(const char* key);
void reset_peak();

Dataset read(const std::string& path);
Tin read_tin(const std::string& path);
Raster read_raster(const std::string& path);

int dem(Words words);
int files(Words words);
int memory(Words words);
int mesh(Words words);
int overlay(Words words);
int triangulate(Words words);
int rasterize(Words words);

}  // namespace terrane::bench
