// SPDX-License-Identifier: GPL-3.0-or-later
#include <malloc.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>

#include "core/error.hpp"
#include "io/geodesy.hpp"
#include "ops/memory.hpp"
#include "tests/bench/bench.hpp"

namespace terrane::bench {
namespace {

/// Without a second copy on the way, which would be the peak.
std::string bytes_of(const std::string& path) {
  std::string bytes(std::filesystem::file_size(path), '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
    throw Error(ErrorKind::input, "unreadable", path + " cannot be read");
  return bytes;
}

Request request_of(const Operation& operation, const std::vector<std::string>& words) {
  Request request;
  request.operation = operation.id;
  for (const std::string& word : words) {
    const auto equals = word.find('=');
    if (word.starts_with("--format=")) {
      request.format = word.substr(equals + 1);
    } else if (word.starts_with("--") && equals != std::string::npos) {
      request.parameters.emplace_back(word.substr(2, equals - 2), word.substr(equals + 1));
    } else {
      const std::size_t slot = std::min(request.inputs.size(), operation.inputs.size() - 1);
      const bool file = std::filesystem::exists(word);
      request.inputs.push_back({operation.inputs.at(slot).name, file ? std::filesystem::path(word).filename() : "", "",
                                file ? bytes_of(word) : word});
    }
  }
  return request;
}

/// The faces of the inputs as ops/memory counts them; those of the result where there are no inputs.
std::size_t faces_of(const nlohmann::json& certificate) {
  std::size_t faces = 0;
  for (const nlohmann::json& input : certificate["inputs"]) {
    const std::size_t own = input.value("faces", std::size_t{0});
    faces += own ? own : 2 * input.value("vertices", std::size_t{0});
  }
  return certificate["inputs"].empty() ? certificate["output"].value("faces", std::size_t{0}) : faces;
}

}  // namespace

/// What one operation takes as a worker of the service does it, with the request in memory, on a thread for each core:
/// bytes of address space at the peak beside what was there before; and what is published.
int memory(Words words) {
  const std::vector<std::string>& all = words.all();
  if (all.empty())
    throw Error(ErrorKind::usage, "usage", "usage: terrane-bench memory OPERATION [INPUT...] [--NAME=VALUE...]");
  mallopt(M_ARENA_MAX, 1);
  load_geodesy();
  const Operation& operation = find_operation(all.front());
  const Plan planned = plan(request_of(operation, {all.begin() + 1, all.end()}));
  Context context;
  context.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const std::uint64_t before = address_space().now;
  Response response = execute(planned, context, {[](std::string_view) {}, true});
  const std::uint64_t bytes = address_space().peak - before;
  nlohmann::json& report = response.report;
  if (report.contains("certificate")) report = nlohmann::json(report["certificate"]);
  nlohmann::json said = {{"bytes", bytes}, {"before", before}, {"faces", faces_of(report)}};
  const auto [face, cell] = memory_figures(operation.id);
  said["bytes_per_face"] = {face.least, face.most};
  said["bytes_per_cell"] = {cell.least, cell.most};
  std::printf("%s\n", said.dump().c_str());
  return 0;
}

}  // namespace terrane::bench
