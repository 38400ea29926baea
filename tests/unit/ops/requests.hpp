// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "ops/operation.hpp"
#include "ops/request.hpp"

// Requests as every door makes them, and small surfaces to make them of.
namespace terrane {

using Parameters = std::vector<std::pair<std::string, std::string>>;

inline Response run(Request request, int threads = 1) {
  Context context;
  context.threads = threads;
  return execute(plan(std::move(request)), context);
}

inline Response run(const std::string& operation, std::vector<InputPart> inputs, Parameters parameters = {},
                    const std::string& format = "") {
  return run({operation, std::move(inputs), std::move(parameters), format});
}

/// What the work is refused with.
template <class Work>
Error refusal_of(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "not refused";
  return {ErrorKind::internal, "not-refused", ""};
}

inline Error refusal(Request request) {
  return refusal_of([&] { run(std::move(request)); });
}

inline Error refusal(const std::string& operation, std::vector<InputPart> inputs, Parameters parameters = {}) {
  return refusal({operation, std::move(inputs), std::move(parameters)});
}

inline bool says(const Error& error, std::string_view words) {
  return std::string_view(error.what()).find(words) != std::string_view::npos;
}

inline bool warned(const Response& r, std::string_view code) {
  return std::any_of(r.warnings.begin(), r.warnings.end(), [&](const Warning& w) { return w.code == code; });
}

inline InputPart part(std::string slot, std::string bytes, std::string name = "") {
  if (name.empty()) name = slot + ".json";
  return {std::move(slot), std::move(name), "", std::move(bytes)};
}

/// A square of two faces from (x, y) on, its height growing with x from `height` by `slope`.
inline std::string square(double x, double y, double size, double height, double slope, const std::string& crs) {
  nlohmann::json tin = {{"type", "TIN"}, {"triangles", {{0, 1, 2}, {0, 2, 3}}}};
  for (auto [u, v] : {std::pair{x, y}, {x + size, y}, {x + size, y + size}, {x, y + size}})
    tin["vertices"].push_back({u, v, height + slope * (u - x)});
  if (!crs.empty()) tin["crs"] = crs;
  return tin.dump();
}

/// n x n cells from (x, y) on, with heights by z(column, row).
template <class Z>
std::string lattice(int n, double x, double y, double cell, Z z, const std::string& crs = "EPSG:25831") {
  nlohmann::json tin = {{"type", "TIN"}};
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) tin["vertices"].push_back({x + cell * i, y + cell * j, z(i, j)});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int v = j * (n + 1) + i;
      tin["triangles"].push_back({v, v + 1, v + n + 2});
      tin["triangles"].push_back({v, v + n + 2, v + n + 1});
    }
  if (!crs.empty()) tin["crs"] = crs;
  return tin.dump();
}

}  // namespace terrane
