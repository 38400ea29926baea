// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/corner_heights.hpp"

#include <algorithm>
#include <cmath>

namespace terrane {
namespace {

/// Corners at a place that are one height; `first` is the position of the earliest in the place's list.
struct Cluster {
  double z;
  std::size_t first;
};

class Closer {
 public:
  Closer(CornerSurface& surface, double z_tolerance) : surface_(surface), z_tolerance_(z_tolerance) {}

  void close(const std::size_t* corners, std::size_t count) {
    const double z = surface_.z[corners[0]];
    std::size_t same = 1;
    while (same < count && surface_.z[corners[same]] == z) ++same;
    if (same == count) return;
    weld(corners, count);
    if (z_tolerance_ > 0 && clusters_.size() > 1) lean_on_first();
    for (std::size_t i = 0; i < count; ++i) {
      const double closed = clusters_[cluster_of_[i]].z;
      double& z = surface_.z[corners[i]];
      largest = std::max(largest, std::fabs(z - closed));
      z = closed;
    }
  }

  double largest = 0;

 private:
  bool firm(std::size_t corner) const { return !surface_.firm.empty() && surface_.firm[corner]; }

  void weld(const std::size_t* corners, std::size_t count) {
    clusters_.clear();
    cluster_of_.assign(count, 0);
    for (const bool firm_ones : {true, false})
      for (std::size_t i = 0; i < count; ++i) {
        if (firm(corners[i]) != firm_ones) continue;
        const double z = surface_.z[corners[i]];
        // The nearest, so that which of two heights a third belongs to does not hang on the order of the faces.
        std::size_t best = clusters_.size();
        double nearest = rounding_jump(z);
        for (std::size_t c = 0; c < clusters_.size(); ++c)
          if (const double d = std::fabs(clusters_[c].z - z); d < nearest || (d == nearest && best == clusters_.size()))
            best = c, nearest = d;
        if (best == clusters_.size()) clusters_.push_back({z, i});
        clusters_[best].first = std::min(clusters_[best].first, i);
        cluster_of_[i] = best;
      }
  }

  void lean_on_first() {
    std::vector<std::size_t> order(clusters_.size()), leaders;
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return clusters_[a].first < clusters_[b].first; });
    for (const std::size_t c : order) {
      const auto leader = std::find_if(leaders.begin(), leaders.end(), [&](std::size_t l) {
        return std::fabs(clusters_[l].z - clusters_[c].z) <= z_tolerance_;
      });
      if (leader == leaders.end())
        leaders.push_back(c);
      else
        clusters_[c].z = clusters_[*leader].z;
    }
  }

  CornerSurface& surface_;
  double z_tolerance_;
  std::vector<Cluster> clusters_;
  std::vector<std::size_t> cluster_of_;
};

}  // namespace

CornersByPlace corners_by_place(const Array<Face>& faces, std::size_t points) {
  CornersByPlace places;
  places.first.assign(points + 1, 0);
  places.corners.resize(3 * faces.size());
  for (const Face& f : faces)
    for (const Index v : f) ++places.first[v + 1];
  for (std::size_t p = 0; p < points; ++p) places.first[p + 1] += places.first[p];
  std::vector<std::size_t> next(places.first.begin(), places.first.end() - 1);
  for (std::size_t c = 0; c < places.corners.size(); ++c) places.corners[next[faces[c / 3][c % 3]]++] = c;
  return places;
}

double close_jumps(CornerSurface& surface, const CornersByPlace& places, double z_tolerance,
                   const std::function<bool(Point2)>& wanted) {
  Closer closer(surface, z_tolerance);
  for (std::size_t p = 0; p < surface.points.size(); ++p) {
    const std::size_t first = places.first[p], count = places.first[p + 1] - first;
    if (count == 0 || (wanted && !wanted(surface.points[p]))) continue;
    closer.close(&places.corners[first], count);
  }
  return closer.largest;
}

}  // namespace terrane
