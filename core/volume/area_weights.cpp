// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/volume/area_weights.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace terrane {
namespace {

constexpr int highest_order = 28;

/// Chebyshev polynomials T_0 .. T_(n-1) at t in [-1, 1].
void chebyshev(double t, int n, double* values) {
  values[0] = 1;
  if (n > 1) values[1] = t;
  for (int k = 2; k < n; ++k) values[k] = 2 * t * values[k - 1] - values[k - 2];
}

Point2 midpoint(Point2 p, Point2 q) { return {0.5 * p.x + 0.5 * q.x, 0.5 * p.y + 0.5 * q.y}; }

}  // namespace

ScaleSheet::ScaleSheet(AreaScale scale, const Box& box) : scale_(std::move(scale)), box_(box) {
  if (!scale_ || !(box.xmax > box.xmin) || !(box.ymax > box.ymin)) return;
  for (const int order : {3, 5, 8, 12, 18, highest_order}) {
    fit(order);
    if (good()) return;
  }
  order_ = 0;
}

double ScaleSheet::operator()(Point2 p) const { return order_ == 0 ? scale_(p.x, p.y) : series(p); }

void ScaleSheet::fit(int order) {
  const int n = order_ = order;
  const auto node = [n](int i) { return std::cos(std::numbers::pi * (i + 0.5) / n); };
  std::vector<double> samples(n * n), rows(n * n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      samples[j * n + i] = scale_(box_.xmin + (box_.xmax - box_.xmin) * 0.5 * (1 + node(i)),
                                  box_.ymin + (box_.ymax - box_.ymin) * 0.5 * (1 + node(j)));
  std::vector<double> cosines(n * n);
  for (int k = 0; k < n; ++k)
    for (int i = 0; i < n; ++i)
      cosines[k * n + i] = (k ? 2.0 : 1.0) / n * std::cos(std::numbers::pi * k * (i + 0.5) / n);
  for (int j = 0; j < n; ++j)
    for (int k = 0; k < n; ++k) {
      double sum = 0;
      for (int i = 0; i < n; ++i) sum += cosines[k * n + i] * samples[j * n + i];
      rows[j * n + k] = sum;
    }
  coefficients_.assign(n * n, 0);
  for (int l = 0; l < n; ++l)
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j) coefficients_[l * n + k] += cosines[l * n + j] * rows[j * n + k];
}

double ScaleSheet::series(Point2 p) const {
  double tx[highest_order], ty[highest_order];
  chebyshev(2 * (p.x - box_.xmin) / (box_.xmax - box_.xmin) - 1, order_, tx);
  chebyshev(2 * (p.y - box_.ymin) / (box_.ymax - box_.ymin) - 1, order_, ty);
  double sum = 0;
  for (int l = order_ - 1; l >= 0; --l) {
    double row = 0;
    for (int k = order_ - 1; k >= 0; --k) row += coefficients_[l * order_ + k] * tx[k];
    sum += row * ty[l];
  }
  return sum;
}

bool ScaleSheet::good() const {
  // Places spread evenly over the box and its border (multiples of the plastic number's inverses).
  for (int i = 0; i < 80; ++i) {
    double u = std::fmod(0.5 + i * 0.7548776662466927, 1), v = std::fmod(0.5 + i * 0.5698402909980532, 1);
    if (i % 4 == 0) u = i % 8 == 0 ? 0 : 1;
    if (i % 4 == 1) v = i % 8 == 1 ? 0 : 1;
    const Point2 p = {box_.xmin + u * (box_.xmax - box_.xmin), box_.ymin + v * (box_.ymax - box_.ymin)};
    const double truth = scale_(p.x, p.y);
    if (!(std::fabs(series(p) - truth) <= 1e-11 * std::fabs(truth))) return false;  // NaN is not good either
  }
  return true;
}

AreaWeights::AreaWeights(const AreaScale& scale, const Box& box) : plain_(!scale), scale_(scale, box) {}

std::array<double, 3> AreaWeights::operator()(const Triangle& t, double area) const {
  if (plain_) return {area / 3, area / 3, area / 3};
  return weigh(t, {scale_(t[0]), scale_(t[1]), scale_(t[2])}, area, 0);
}

/// How far the scale is from linear on the edges decides: nothing above rounding, and the corners are enough; up to
/// 2e-4, and a rule of degree 5 (exact for a scale of degree 4) errs by less than 1e-11; beyond, in quarters.
std::array<double, 3> AreaWeights::weigh(const Triangle& t, const std::array<double, 3>& at, double area,
                                         int depth) const {
  std::array<double, 3> between;
  double bend = 0;
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3;
    between[k] = scale_(midpoint(t[k], t[l]));
    bend = std::max(bend, std::fabs(0.5 * (at[k] + at[l]) - between[k]) / std::fabs(between[k]));
  }
  if (bend > 2e-4 && depth < 8) return quarters(t, at, between, area, depth);
  if (bend > 1e-10) return quadrature(t, area);
  const double sum = at[0] + at[1] + at[2];
  return {area / 12 * (sum + at[0]), area / 12 * (sum + at[1]), area / 12 * (sum + at[2])};
}

std::array<double, 3> AreaWeights::quarters(const Triangle& t, const std::array<double, 3>& at,
                                            const std::array<double, 3>& between, double area, int depth) const {
  const Triangle middle = {midpoint(t[0], t[1]), midpoint(t[1], t[2]), midpoint(t[2], t[0])};
  std::array<double, 3> weights = {0, 0, 0};
  for (int k = 0; k < 3; ++k) {  // the quarter at corner k; middle[k] lies between corners k and k + 1
    const int next = (k + 1) % 3, last = (k + 2) % 3;
    const auto w = weigh({t[k], middle[k], middle[last]}, {at[k], between[k], between[last]}, area / 4, depth + 1);
    weights[k] += w[0] + 0.5 * (w[1] + w[2]);
    weights[next] += 0.5 * w[1];
    weights[last] += 0.5 * w[2];
  }
  const auto w = weigh(middle, between, area / 4, depth + 1);
  for (int k = 0; k < 3; ++k) {
    weights[k] += 0.5 * w[k];
    weights[(k + 1) % 3] += 0.5 * w[k];
  }
  return weights;
}

/// Radon's rule of seven points (1948), degree 5.
std::array<double, 3> AreaWeights::quadrature(const Triangle& t, double area) const {
  static const double root = std::sqrt(15.0);
  std::array<double, 3> weights = {0, 0, 0};
  const auto add = [&](double a, double b, double c, double weight) {
    const Point2 p = {a * t[0].x + b * t[1].x + c * t[2].x, a * t[0].y + b * t[1].y + c * t[2].y};
    const double s = weight * area * scale_(p);
    weights[0] += s * a, weights[1] += s * b, weights[2] += s * c;
  };
  add(1.0 / 3, 1.0 / 3, 1.0 / 3, 9.0 / 40);
  for (const double sign : {-1.0, 1.0}) {
    const double a = (6 + sign * root) / 21, b = 1 - 2 * a, weight = (155 + sign * root) / 1200;
    add(a, a, b, weight), add(a, b, a, weight), add(b, a, a, weight);
  }
  return weights;
}

}  // namespace terrane
