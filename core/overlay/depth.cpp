// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay/depth.hpp"

#include <algorithm>
#include <limits>

#include "core/triangle_height.hpp"

namespace terrane {
namespace {

Point2 minus(Point2 p, Point2 q) { return {p.x - q.x, p.y - q.y}; }
Point2 times(Point2 p, double t) { return {p.x * t, p.y * t}; }

}  // namespace

double Depth::of(std::span<const Point2> corners) {
  double deepest = 0;
  std::vector<const Seen*> seen;
  for (const Point2 p : corners) {
    const auto [known, is_new] = seen_.try_emplace({p.x, p.y});
    if (is_new) known->second = look(p, {0, 0});
    seen.push_back(&known->second);
    deepest = std::max(deepest, seen.back()->depth);
  }
  for (std::size_t k = 0; corners.size() > 1 && deepest <= enough_ && k < corners.size(); ++k) {
    const std::size_t l = (k + 1) % corners.size();
    deepest = std::max(deepest, between(corners[k], minus(corners[l], corners[k]), 0, *seen[k], 1, *seen[l]));
  }
  return deepest;
}

Depth::Seen Depth::look(Point2 from, Point2 way) {
  Seen seen;
  last_ = face_at(mesh_, locate(mesh_, {from.x + way.x, from.y + way.y}, last_));
  const bool inside = mesh_.real(last_);
  double least = std::numeric_limits<double>::infinity();
  near_.clear();
  const auto visit = [&](Index face) {
    if (!visited_[face]) near_.push_back(face);
    visited_[face] = true;
  };
  visit(last_);
  for (std::size_t i = 0; i < near_.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const Index h = 4 * near_[i] + k, twin = mesh_.twin(h);
      double distance;
      nearest_on_segment(minus(mesh_.at(mesh_.origin(h)), from), minus(mesh_.at(mesh_.target(h)), from), way, distance);
      if (twin == none || distance > (inside ? reach_ : enough_)) continue;
      const Index beyond = twin >> 2;
      const bool border = mesh_.real(near_[i]) != mesh_.real(beyond);
      if (border) least = std::min(least, distance);
      if (border && distance <= enough_) seen.border.push_back(mesh_.edge_of(h));
      visit(beyond);
    }
  for (const Index face : near_) visited_[face] = false;
  if (inside) seen.depth = least;
  return seen;
}

/// What is close to one edge is convex: two places close to it do for all between them. Else both halves are looked at.
double Depth::between(Point2 from, Point2 way, double start, const Seen& at_start, double stop, const Seen& at_stop) {
  constexpr double too_short = 1e-12;
  for (const Index edge : at_start.border)
    if (std::find(at_stop.border.begin(), at_stop.border.end(), edge) != at_stop.border.end()) return 0;
  if (at_start.border.empty() || at_stop.border.empty() || stop - start < too_short) return 0;
  const double middle = start + (stop - start) / 2;
  const Seen seen = look(from, times(way, middle));
  if (seen.depth > enough_) return seen.depth;
  return std::max(
      {seen.depth, between(from, way, start, at_start, middle, seen), between(from, way, middle, seen, stop, at_stop)});
}

}  // namespace terrane
