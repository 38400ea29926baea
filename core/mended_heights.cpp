// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mended_heights.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace terrane {
namespace {

bool same(double z, double other) { return std::fabs(z - other) <= std::max(1e-6, 1e-9 * std::fabs(z)); }

}  // namespace

bool mend_heights(const OverlayFaces& work, const Array<Point2>& points, const FaceHeights& heights, int m,
                  const std::vector<Index>& relabelled, Array<double>& z) {
  std::map<Index, std::vector<double>> beyond;  // of a vertex: its heights beside z[v], each once
  std::vector<std::pair<std::size_t, double>> own;
  for (Index f : relabelled)
    for (int k = 0; k < 3 && work.parents[f][m] != none; ++k) {
      const Index v = work.faces[f][k];
      const double height = heights.at(work.parents[f][m], v, points[v]);
      if (std::isnan(z[v])) z[v] = height;
      if (same(height, z[v])) continue;
      std::vector<double>& there = beyond[v];
      auto at = std::find_if(there.begin(), there.end(), [&](double other) { return same(height, other); });
      if (at == there.end()) at = there.insert(at, height);
      own.emplace_back(3 * static_cast<std::size_t>(f) + k, *at);
    }
  if (own.empty()) return false;
  Array<double> corners(3 * work.faces.size());
  for (std::size_t c = 0; c < corners.size(); ++c) corners[c] = z[work.faces[c / 3][c % 3]];
  for (const auto& [corner, height] : own) corners[corner] = height;
  z = std::move(corners);
  return true;
}

}  // namespace terrane
