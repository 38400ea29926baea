// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge/line_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "core/box.hpp"

namespace terrane {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

double squared_distance(const Box& box, Point2 p) {
  const double dx = std::max({box.xmin - p.x, 0.0, p.x - box.xmax});
  const double dy = std::max({box.ymin - p.y, 0.0, p.y - box.ymax});
  return dx * dx + dy * dy;
}

Box box_of(const LineDistance::Segment& s) {
  return {std::min(s.p.x, s.q.x), std::min(s.p.y, s.q.y), std::max(s.p.x, s.q.x), std::max(s.p.y, s.q.y)};
}

/// The largest the sum of l_i l_j q_ij can be in a triangle, l the weights of its corners, in size.
double largest_quadratic(const std::array<double, 3>& q) {
  double bound = 0;
  for (const double sign : {1.0, -1.0}) {
    int count = 0;
    double largest = 0;
    for (const double v : q)
      if (sign * v > 0) ++count, largest = std::max(largest, sign * v);
    bound = std::max(bound, largest / (count == 3 ? 3 : 4));
  }
  return bound;
}

std::array<double, 3> products_of_differences(const std::array<double, 3>& f, const std::array<double, 3>& g) {
  return {(f[0] - f[1]) * (g[0] - g[1]), (f[1] - f[2]) * (g[1] - g[2]), (f[2] - f[0]) * (g[2] - g[0])};
}

double largest_difference(const std::array<double, 3>& f, const std::array<double, 3>& g) {
  return std::max({f[0] - g[0], f[1] - g[1], f[2] - g[2]});
}

}  // namespace

OverTriangle constant(double value) { return {{value, value, value}, 0, 0}; }

OverTriangle scaled(const OverTriangle& f, double factor) {
  return {{f.at[0] * factor, f.at[1] * factor, f.at[2] * factor}, f.up * factor, f.down * factor};
}

OverTriangle larger(const OverTriangle& f, const OverTriangle& g) {
  OverTriangle r;
  for (int k = 0; k < 3; ++k) r.at[k] = std::max(f.at[k], g.at[k]);
  r.up = std::max(f.up, g.up);  // the interpolation of the larger is above both interpolations
  r.down = std::min(largest_difference(r.at, f.at) + f.down, largest_difference(r.at, g.at) + g.down);
  return r;
}

OverTriangle smaller(const OverTriangle& f, const OverTriangle& g) {
  OverTriangle r;
  for (int k = 0; k < 3; ++k) r.at[k] = std::min(f.at[k], g.at[k]);
  r.down = std::max(f.down, g.down);
  r.up = std::min(largest_difference(f.at, r.at) + f.up, largest_difference(g.at, r.at) + g.up);
  return r;
}

OverTriangle share(const OverTriangle& f, const OverTriangle& g) {
  OverTriangle r;
  std::array<double, 3> sum;
  for (int k = 0; k < 3; ++k) {
    sum[k] = f.at[k] + g.at[k];
    r.at[k] = sum[k] > 0 ? f.at[k] / sum[k] : 0;
  }
  const double least = std::min({sum[0], sum[1], sum[2]}), least_true = least - f.error() - g.error();
  if (!(least_true > 0)) {
    r.up = r.down = infinite;
    return r;
  }
  // What f and g being not linear changes, and what the quotient of two linear functions differs from one.
  r.up = std::max(f.error(), g.error()) / least_true + largest_quadratic(products_of_differences(r.at, sum)) / least;
  r.down = r.up;
  return r;
}

double error_of_product(const OverTriangle& f, const std::array<double, 3>& d) {
  const double largest = std::max({std::fabs(d[0]), std::fabs(d[1]), std::fabs(d[2])});
  return (largest > 0 ? f.error() * largest : 0) + largest_quadratic(products_of_differences(f.at, d));
}

LineDistance::LineDistance(std::span<const Segment> segments, Point2 metric, bool straighten) : metric_(metric) {
  for (const Segment& s : segments) segments_.push_back({metric_point(s.p), metric_point(s.q)});
  if (straighten) this->straighten();
  order_.resize(segments_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (!order_.empty()) build(0, order_.size());
}

/// Runs grow as long as one direction from their beginning passes all their vertices within rounding.
void LineDistance::straighten() {
  double largest = 0;
  for (const Segment& s : segments_)
    for (const double c : {s.p.x, s.p.y, s.q.x, s.q.y}) largest = std::max(largest, std::fabs(c));
  straightened_ = 8 * std::numeric_limits<double>::epsilon() * largest;
  const auto before = [](Point2 a, Point2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; };
  std::map<Point2, std::pair<std::size_t, int>, decltype(before)> leaving(before);  // the segment, and how many
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    auto& [segment, count] = leaving[segments_[i].p];
    segment = i, ++count;
  }
  std::vector<bool> taken(segments_.size()), follows(segments_.size());
  const auto next = [&](std::size_t i) {
    const auto it = leaving.find(segments_[i].q);
    return it == leaving.end() || it->second.second != 1 ? segments_.size() : it->second.first;
  };
  const auto straight_on = [&](std::size_t i, std::size_t j) {
    const Segment &s = segments_[i], &t = segments_[j];
    const double ux = s.q.x - s.p.x, uy = s.q.y - s.p.y, vx = t.q.x - s.p.x, vy = t.q.y - s.p.y;
    return ux * (t.q.x - t.p.x) + uy * (t.q.y - t.p.y) > 0 &&
           std::fabs(ux * vy - uy * vx) <= straightened_ * std::hypot(vx, vy);
  };
  for (std::size_t i = 0; i < segments_.size(); ++i)
    if (const std::size_t n = next(i); n < segments_.size() && n != i && straight_on(i, n)) follows[n] = true;
  std::vector<Segment> runs;
  const auto run_from = [&](std::size_t start) {
    const Point2 origin = segments_[start].p;
    const double length = std::hypot(segments_[start].q.x - origin.x, segments_[start].q.y - origin.y);
    const Point2 u = {(segments_[start].q.x - origin.x) / length, (segments_[start].q.y - origin.y) / length};
    double low = -infinite, high = infinite;  // slopes against u that pass all vertices
    std::size_t i = start;
    while (true) {
      taken[i] = true;
      const double dx = segments_[i].q.x - origin.x, dy = segments_[i].q.y - origin.y, along = u.x * dx + u.y * dy;
      const double slope = (u.x * dy - u.y * dx) / along, slack = straightened_ / along;
      low = std::max(low, slope - slack), high = std::min(high, slope + slack);
      const std::size_t n = next(i);
      if (n >= segments_.size() || taken[n]) break;
      const double nx = segments_[n].q.x - origin.x, ny = segments_[n].q.y - origin.y, far = u.x * nx + u.y * ny;
      const double towards = (u.x * ny - u.y * nx) / far;
      if (!(far > along) || !(towards >= low && towards <= high)) break;
      i = n;
    }
    runs.push_back({origin, segments_[i].q});
  };
  for (std::size_t i = 0; i < segments_.size(); ++i)
    if (!follows[i] && !taken[i]) run_from(i);
  for (std::size_t i = 0; i < segments_.size(); ++i)
    if (!taken[i]) run_from(i);
  segments_ = std::move(runs);
}

std::size_t LineDistance::build(std::size_t first, std::size_t last) {
  Box box = no_box;
  for (std::size_t i = first; i < last; ++i) box = around(box, box_of(segments_[order_[i]]));
  const std::size_t node = nodes_.size();
  nodes_.push_back({box, first, last, 0, 0});
  if (last - first <= 4) return node;
  const bool along_x = box.xmax - box.xmin > box.ymax - box.ymin;
  const std::size_t middle = first + (last - first) / 2;
  const auto key = [&](std::size_t s) {
    const Segment& e = segments_[s];
    return std::pair(along_x ? e.p.x + e.q.x : e.p.y + e.q.y, s);
  };
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  const std::size_t left = build(first, middle), right = build(middle, last);
  nodes_[node].left = left, nodes_[node].right = right;
  return node;
}

double LineDistance::squared(std::size_t segment, Point2 p, double* where) const {
  const Segment& s = segments_[segment];
  const double ux = s.q.x - s.p.x, uy = s.q.y - s.p.y, wx = p.x - s.p.x, wy = p.y - s.p.y;
  const double length2 = ux * ux + uy * uy;
  const double t = length2 > 0 ? std::clamp((wx * ux + wy * uy) / length2, 0.0, 1.0) : 0;
  if (where) *where = t;
  if (t > 0 && t < 1) {  // across the segment, so that cancellation along it is of no account
    const double across = ux * wy - uy * wx;
    return across * across / length2;
  }
  const double dx = t == 0 ? wx : p.x - s.q.x, dy = t == 0 ? wy : p.y - s.q.y;
  return dx * dx + dy * dy;
}

void LineDistance::find(Point2 p, double& best, std::size_t& which) const {
  std::vector<std::pair<double, std::size_t>> stack;
  stack.reserve(64);
  stack.emplace_back(squared_distance(nodes_[0].box, p), 0);
  while (!stack.empty()) {
    const auto [least, n] = stack.back();
    stack.pop_back();
    if (least > best) continue;
    const Node& node = nodes_[n];
    if (node.left == 0) {
      for (std::size_t i = node.first; i < node.last; ++i)
        if (const double d = squared(order_[i], p); d < best || (d == best && order_[i] < which))
          best = d, which = order_[i];
      continue;
    }
    const std::pair l{squared_distance(nodes_[node.left].box, p), node.left},
        r{squared_distance(nodes_[node.right].box, p), node.right};
    stack.push_back(std::max(l, r));
    stack.push_back(std::min(l, r));
  }
}

void LineDistance::gather(Point2 p, double radius, std::vector<std::size_t>& found) const {
  std::vector<std::size_t> stack = {0};
  while (!stack.empty()) {
    const Node& node = nodes_[stack.back()];
    stack.pop_back();
    if (squared_distance(node.box, p) > radius * radius) continue;
    if (node.left != 0) {
      stack.push_back(node.right);
      stack.push_back(node.left);
      continue;
    }
    for (std::size_t i = node.first; i < node.last; ++i)
      if (squared(order_[i], p) <= radius * radius) found.push_back(order_[i]);
  }
}

double LineDistance::at(Point2 p, double cap) const {
  double best = cap * cap;
  std::size_t which = segments_.size();
  find(metric_point(p), best, which);
  return which == segments_.size() ? cap : std::min(cap, std::sqrt(best));
}

LineDistance::Nearest LineDistance::nearest(Point2 p) const {
  double best = infinite, t = 0;
  std::size_t which = segments_.size();
  find(metric_point(p), best, which);
  squared(which, metric_point(p), &t);
  return {which, t, std::sqrt(best)};
}

OverTriangle LineDistance::over(const std::array<Point2, 3>& triangle, const std::array<double, 3>& known,
                                double cap) const {
  std::array<Point2, 3> p;
  Point2 c;
  for (int k = 0; k < 3; ++k) {
    p[k] = metric_point(triangle[k]);
    c.x += p[k].x / 3, c.y += p[k].y / 3;
  }
  double radius = 0;
  for (const Point2 v : p) radius = std::max(radius, std::hypot(v.x - c.x, v.y - c.y));
  double best = (cap + radius) * (cap + radius);
  std::size_t which = segments_.size();
  find(c, best, which);
  if (which == segments_.size()) return constant(cap);
  std::vector<std::size_t> near;
  gather(c, (std::sqrt(best) + 2 * radius) * (1 + 1e-12), near);

  std::array<double, 3> at = {infinite, infinite, infinite};
  std::vector<std::array<double, 3>> own;
  for (const std::size_t s : near) {
    own.push_back({std::sqrt(squared(s, p[0])), std::sqrt(squared(s, p[1])), std::sqrt(squared(s, p[2]))});
    for (int k = 0; k < 3; ++k) at[k] = std::min(at[k], own.back()[k]);
  }
  for (int k = 0; k < 3; ++k)
    if (known[k] < cap) at[k] = known[k];
  OverTriangle distance{at, infinite, 0};
  for (std::size_t i = 0; i < near.size(); ++i) {
    distance.up = std::min(distance.up, std::max(0.0, largest_difference(own[i], at)));
    const Segment& s = segments_[near[i]];
    double t;
    const double d = std::sqrt(squared(near[i], c, &t));
    const Point2 foot = {s.p.x + t * (s.q.x - s.p.x), s.p.y + t * (s.q.y - s.p.y)};
    const double gx = d > 0 ? (c.x - foot.x) / d : 0, gy = d > 0 ? (c.y - foot.y) / d : 0;
    for (int k = 0; k < 3; ++k)
      distance.down = std::max(distance.down, at[k] - (d + gx * (p[k].x - c.x) + gy * (p[k].y - c.y)));
  }
  distance.up += straightened_, distance.down += straightened_;
  return smaller(distance, constant(cap));
}

}  // namespace terrane
