// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <vector>

namespace terrane {

/// Calls keep(k) for the samples of a line of n + 1, without its ends, that hold the others within `tolerance` of the
/// straight lines between them (Douglas & Peucker 1973); in no particular order. `height(k)` is sample k. None are kept
/// where tolerance < 0. O(n log n) expected.
template <class Height, class Keep>
void thin_line(int n, Height height, double tolerance, Keep keep) {
  if (tolerance < 0) return;
  std::vector<std::array<int, 2>> spans{{0, n}};
  while (!spans.empty()) {
    const auto [a, b] = spans.back();
    spans.pop_back();
    const double za = height(a), rise = height(b) - za, slope = rise / (b - a);
    int worst = -1;
    double largest = tolerance - 1e-9 * std::fabs(rise);  // room for what the doubles of the places will round
    for (int k = a + 1; k < b; ++k) {
      const double error = std::fabs(height(k) - (za + slope * (k - a)));
      if (error > largest) {
        largest = error;
        worst = k;
      }
    }
    if (worst < 0) continue;
    keep(worst);
    spans.push_back({a, worst});
    spans.push_back({worst, b});
  }
}

/// The same for each run of samples that exist (are no NaN) among `count` of them; the ends of runs are not reported.
/// Returns how many exist.
template <class Height, class Keep>
int thin_runs(int count, Height height, double tolerance, Keep keep) {
  int existing = 0;
  for (int a = 0, b; a < count; a = b + 1) {
    for (b = a; b < count && !std::isnan(height(b));) ++b;
    existing += b - a;
    if (b - a > 2) {
      thin_line(
          b - a - 1, [&](int k) { return height(a + k); }, tolerance, [&](int k) { keep(a + k); });
    }
  }
  return existing;
}

}  // namespace terrane
