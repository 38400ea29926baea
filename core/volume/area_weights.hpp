// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "core/tin.hpp"
#include "core/volume.hpp"

// Integrals of (area scale) * (linear function) over triangles, to 1e-9 relative or better for smooth scales.
namespace terrane {

/// A scale over a box as a Chebyshev series, because asking a map projection millions of times takes minutes: a
/// thousand questions are enough, and the series is tried against the scale itself at other places. Where it cannot be
/// made accurate to 1e-11 the scale is asked directly.
class ScaleSheet {
 public:
  ScaleSheet(AreaScale scale, const Box& box);
  double operator()(Point2 p) const;
  bool exact() const { return order_ == 0; }  // asks the scale itself

 private:
  void fit(int order);
  double series(Point2 p) const;
  bool good() const;

  AreaScale scale_;
  Box box_;
  int order_ = 0;
  std::vector<double> coefficients_;  // order_ * order_, rows along y
};

/// The weights w of the corners of triangles: sum of w[i] * v[i] is the integral of scale * v for any v linear on the
/// triangle. Without a scale, a third of the area each.
class AreaWeights {
 public:
  /// `box` holds every place that will be asked about.
  AreaWeights(const AreaScale& scale, const Box& box);
  /// `area`: that of the triangle in plan, which the caller often knows better than its rounded corners do.
  std::array<double, 3> operator()(const std::array<Point2, 3>& triangle, double area) const;

 private:
  using Triangle = std::array<Point2, 3>;
  std::array<double, 3> weigh(const Triangle& t, const std::array<double, 3>& at, double area, int depth) const;
  std::array<double, 3> quadrature(const Triangle& t, double area) const;
  std::array<double, 3> quarters(const Triangle& t, const std::array<double, 3>& at,
                                 const std::array<double, 3>& between, double area, int depth) const;
  bool plain_;
  ScaleSheet scale_;
};

}  // namespace terrane
