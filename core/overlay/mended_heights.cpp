// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay/mended_heights.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/triangle_height.hpp"

namespace terrane {

bool mend_heights(const Array<Face>& faces, const std::vector<Index>& changed,
                  const std::function<OwnHeights(Index face)>& own_heights, Array<double>& z) {
  std::map<Index, std::vector<double>> beyond;  // of a vertex: its heights beside z[v], each once
  std::vector<std::pair<std::size_t, double>> own;
  for (Index f : changed) {
    const OwnHeights here = own_heights(f);
    for (int k = 0; k < 3; ++k) {
      const Index v = faces[f][k];
      const double height = here.z[k];
      const auto same = [&](double other) { return here.error.covers(height, other); };
      if (std::isnan(z[v])) z[v] = height;
      if (same(z[v])) continue;
      std::vector<double>& there = beyond[v];
      auto at = std::find_if(there.begin(), there.end(), same);
      if (at == there.end()) at = there.insert(at, height);
      own.emplace_back(3 * static_cast<std::size_t>(f) + k, *at);
    }
  }
  if (own.empty()) return false;
  Array<double> corners(3 * faces.size());
  for (std::size_t c = 0; c < corners.size(); ++c) corners[c] = z[faces[c / 3][c % 3]];
  for (const auto& [corner, height] : own) corners[corner] = height;
  z = std::move(corners);
  return true;
}

HeightError height_error(const Point2 (&c)[3], const double (&z)[3], double max_move) {
  const double rise = max_move > 0 ? slope_of_triangle(c, z) * (100 * max_move) : 0;
  const double largest = std::max({1.0, std::fabs(z[0]), std::fabs(z[1]), std::fabs(z[2])});
  const auto [lowest, highest] = std::minmax({z[0], z[1], z[2]});
  const double beyond = 1e-6 * (highest - lowest) + 1e-12 * largest;  // a vertex may lie there by as little
  return {rise + 1e-12 * largest, lowest - beyond, highest + beyond};
}

}  // namespace terrane
