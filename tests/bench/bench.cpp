// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/bench.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "core/error.hpp"

namespace terrane::bench {

double Words::number(const std::string& name, double otherwise) {
  const auto at = std::find(words_.begin(), words_.end(), name);
  if (at == words_.end()) return otherwise;
  char* end = nullptr;
  const double value = at + 1 == words_.end() ? 0 : std::strtod(at[1].c_str(), &end);
  if (!end || end == at[1].c_str() || *end != '\0') throw Error(ErrorKind::usage, "usage", name + " needs a number");
  words_.erase(at, at + 2);
  return value;
}

bool Words::flag(const std::string& name) { return std::erase(words_, name) > 0; }

std::vector<std::string> Words::files(std::size_t count, const std::string& usage) const {
  const bool option = std::any_of(words_.begin(), words_.end(), [](const auto& w) { return w.starts_with("--"); });
  if (option || words_.size() != count) throw Error(ErrorKind::usage, "usage", "usage: terrane-bench " + usage);
  return words_;
}

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

std::size_t status_bytes(const char* key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(key)) return std::strtoull(line.c_str() + std::string(key).size(), nullptr, 10) * 1024;
  return 0;
}

void reset_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

Dataset read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  if (!(bytes << file.rdbuf())) throw Error(ErrorKind::input, "unreadable", path + " cannot be read");
  const Format* format = format_of_file(path);
  if (!format || !format->read) throw Error(ErrorKind::usage, "unknown-format", path + ": not a format we read");
  Context context;
  return format->read(bytes.str(), {.name = path}, context);
}

Tin read_tin(const std::string& path) {
  Dataset dataset = read(path);
  if (!std::holds_alternative<Tin>(dataset.surface)) throw Error(ErrorKind::usage, "not-a-tin", path + " is no TIN");
  return std::get<Tin>(std::move(dataset.surface));
}

Raster read_raster(const std::string& path) {
  Dataset dataset = read(path);
  if (!std::holds_alternative<Raster>(dataset.surface))
    throw Error(ErrorKind::usage, "not-a-raster", path + " is no raster");
  return std::get<Raster>(std::move(dataset.surface));
}

}  // namespace terrane::bench
