// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/tin.hpp"

// Distances in plan to a set of lines, and how far they are from linear over a triangle: proven, not sampled.
namespace terrane {

/// A function over a triangle by its values at the corners: nowhere in the triangle is it above their linear
/// interpolation by more than `up`, or below it by more than `down`. Rounding aside.
struct OverTriangle {
  std::array<double, 3> at{};
  double up = 0, down = 0;
  double error() const { return up > down ? up : down; }
};

OverTriangle scaled(const OverTriangle& f, double factor);  // factor >= 0
OverTriangle larger(const OverTriangle& f, const OverTriangle& g);
OverTriangle smaller(const OverTriangle& f, const OverTriangle& g);
OverTriangle constant(double value);
/// f / (f + g) for f, g >= 0; the bound is infinite where f + g may be 0.
OverTriangle share(const OverTriangle& f, const OverTriangle& g);
/// The error of interpolating f * d linearly, d linear with these values at the corners.
double error_of_product(const OverTriangle& f, const std::array<double, 3>& d);

class LineDistance {
 public:
  struct Segment {
    Point2 p, q;  // may be one place
  };
  /// Lengths along x and y count `metric` times. Runs of segments, each beginning where another ends, that are straight
  /// but for rounding become one where `straighten` allows it: then a distance is linear all along them.
  LineDistance(std::span<const Segment> segments, Point2 metric, bool straighten);

  bool empty() const { return segments_.empty(); }
  /// The distance to the nearest segment, or `cap` where that is less. O(log n) in most cases.
  double at(Point2 p, double cap) const;
  /// The nearest place on the lines; of segments that were not straightened, by the number each was given.
  struct Nearest {
    std::size_t segment;
    double t;  // along it, 0 to 1
    double distance;
  };
  Nearest nearest(Point2 p) const;
  /// min(distance, cap) over a triangle. `known` are its values at the corners. The distance to one segment is convex,
  /// so it lies between its tangent plane and its interpolation; the distance to all is the least of those of the
  /// segments that can be nearest somewhere in the triangle.
  OverTriangle over(const std::array<Point2, 3>& triangle, const std::array<double, 3>& known, double cap) const;

 private:
  struct Node {
    Box box;
    std::size_t first, last;  // of order_
    std::size_t left, right;  // 0: a leaf
  };
  Point2 metric_point(Point2 p) const { return {p.x * metric_.x, p.y * metric_.y}; }
  void straighten();
  std::size_t build(std::size_t first, std::size_t last);
  double squared(std::size_t segment, Point2 p, double* t = nullptr) const;
  void find(Point2 p, double& best, std::size_t& which) const;
  void gather(Point2 p, double radius, std::vector<std::size_t>& found) const;

  Point2 metric_;
  double straightened_ = 0;        // how far lines may have moved by making runs one
  std::vector<Segment> segments_;  // in the metric
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace terrane
